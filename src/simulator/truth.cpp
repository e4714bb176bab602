// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/truth.hpp"

#include <algorithm>
#include <cmath>

namespace pf::simulator {
namespace {

/// How deep under the skin a joint may lie, metres.
double depthUnderSkin(std::size_t joint) {
  switch (static_cast<Joint>(joint)) {
    case Joint::right_hip:
    case Joint::left_hip:
    case Joint::neck:
    case Joint::right_shoulder:
    case Joint::left_shoulder:
      return 0.22;
    case Joint::nose:
    case Joint::right_eye:
    case Joint::left_eye:
      return 0.05;
    case Joint::right_ear:
    case Joint::left_ear:
      return 0.07;
    default:
      return 0.13;
  }
}

}  // namespace

PersonTruth observe(int person, const std::array<Eigen::Vector3f, kJointCount>& joints_world,
                    const PinholeCamera& camera, const Eigen::Isometry3d& T_world_camera,
                    const DepthView& view) {
  PersonTruth truth;
  truth.id = person + 1;
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  for (std::size_t j = 0; j < joints_world.size(); ++j) {
    truth.joints_world_m[j] = joints_world[j].cast<double>();
    const Eigen::Vector3d p = T_camera_world * truth.joints_world_m[j];
    truth.joints_px[j] = Eigen::Vector2d(-1.0, -1.0);
    if (p.z() < 0.05) continue;
    truth.joints_px[j] = camera.project(p);
    const int col = static_cast<int>(std::lround(truth.joints_px[j].x()));
    const int row = static_cast<int>(std::lround(truth.joints_px[j].y()));
    if (col < 0 || row < 0 || col >= camera.width || row >= camera.height) continue;
    truth.in_view[j] = true;
    const float surface = view.depth_m.at<float>(row, col);
    truth.visible[j] =
        view.label.at<std::uint8_t>(row, col) == truth.id && surface > p.z() - depthUnderSkin(j);
  }
  for (int row = 0; row < view.label.rows; ++row) {
    const auto* line = view.label.ptr<std::uint8_t>(row);
    truth.pixels += static_cast<int>(std::count(line, line + view.label.cols, truth.id));
  }
  return truth;
}

People asDetected(const SimulatedFrame& frame) {
  People people;
  people.stamp_ns = frame.frame.stamp_ns;
  people.detected = true;
  for (const PersonTruth& truth : frame.people) {
    Person person;
    for (std::size_t j = 0; j < person.joints.size(); ++j) {
      if (!truth.visible[j]) continue;
      person.joints[j] = {static_cast<float>(truth.joints_px[j].x()),
                          static_cast<float>(truth.joints_px[j].y()), 1.0F};
      person.score = 1.0F;
    }
    if (person.score > 0.0F && people.people.size() < 15) people.people.push_back(person);
  }
  return people;
}

}  // namespace pf::simulator

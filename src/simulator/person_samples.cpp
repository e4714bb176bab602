// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/person_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "posefusion/pose/depth_input.hpp"
#include "simulator/depth_flaws.hpp"
#include "simulator/depth_sensor.hpp"
#include "simulator/person_cast.hpp"
#include "simulator/posture.hpp"
#include "simulator/truth.hpp"

namespace pf::simulator {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kCamerasPerArrangement = 4;
constexpr int kShrink = 4;  ///< of 640x480

PinholeCamera drawCamera(Dice& dice) {
  PinholeCamera camera;
  camera.width = kDepthInputWidth;
  camera.height = kDepthInputHeight;
  camera.fx = camera.fy = dice.chance(0.85) ? dice.between(124, 150) : dice.between(95, 124);
  camera.cx = 0.5 * (camera.width - 1) + dice.between(-2.5, 2.5);
  camera.cy = 0.5 * (camera.height - 1) + dice.between(-2.5, 2.5);
  return camera;
}

/// From 0.4 to 8 m off the focus, sometimes past the shoulder of another person nearby.
Vector3d drawEye(const Arrangement& people, Dice& dice) {
  const double lot = dice.between(0.0, 1.0), bearing = dice.between(0.0, 2.0 * M_PI);
  const Vector3d& focus = people.focus;
  if (!people.others.empty() && dice.chance(0.2)) {
    const auto one = static_cast<std::size_t>(dice.below(static_cast<int>(people.others.size())));
    const Vector2d beside = people.others[one] - focus.head<2>();
    const Vector2d along = beside.normalized(), across(-along.y(), along.x());
    const Vector2d eye =
        people.others[one] + dice.between(0.4, 1.6) * along + dice.between(-0.5, 0.5) * across;
    return {eye.x(), eye.y(), focus.z()};
  }
  const double distance = lot < 0.2    ? dice.between(0.4, 1.2)
                          : lot < 0.72 ? dice.between(1.0, 4.0)
                                       : dice.between(3.0, 8.0);
  return focus + distance * Vector3d(std::cos(bearing), std::sin(bearing), 0.0);
}

/// Within the room; mostly about level, sometimes as in a fall. In every fifth picture the person
/// in focus is at the border or cut by it, in every tenth anywhere.
Isometry3d drawView(const PersonRoom& room, const Arrangement& people, Dice& dice) {
  const Vector3d& focus = people.focus;
  Vector3d eye = drawEye(people, dice);
  for (int i = 0; i < 2; ++i) eye[i] = std::clamp(eye[i], 0.15, room.size_m[i] - 0.15);
  eye.z() = dice.between(0.4, 1.9);
  const double distance = (focus - eye).head<2>().norm();
  Vector3d target = focus;
  const double where = dice.between(0.0, 1.0);
  const double astray = where < 0.1 ? 2.0 : where < 0.3 ? 0.8 : 0.3;
  target.x() += astray * dice.between(-1.0, 1.0) * distance;
  target.y() += astray * dice.between(-1.0, 1.0) * distance;
  target.z() += 0.15 * dice.between(-1.0, 1.0) * distance;
  if ((target - eye).head<2>().norm() < 0.05) target.x() += 0.3;
  const double manner = dice.between(0.0, 1.0);
  const bool falling = manner > 0.84, down = manner > 0.95;
  if (down) eye.z() = dice.between(0.1, 0.5);
  // About level: a robot looks ahead and a little down, whatever is there.
  if (!falling)
    target.z() = eye.z() + std::clamp(target.z() - eye.z(), -0.6 * distance, 0.3 * distance);
  Isometry3d view = lookAt(eye, target);
  const double roll = falling ? dice.between(-1.7, 1.7) : 0.06 * gaussian(dice.next());
  const double pitch = falling ? dice.between(-0.6, 0.6) : 0.06 * gaussian(dice.next());
  view.rotate(AngleAxisd(roll, Vector3d::UnitZ()));
  view.rotate(AngleAxisd(pitch, Vector3d::UnitX()));
  return view;
}

/// Cameras inside of things show nothing.
bool isWorthShowing(const cv::Mat& depth_m) {
  const int near = cv::countNonZero((depth_m > 0.0F) & (depth_m < 0.35F));
  return near < static_cast<int>(depth_m.total()) / 3;
}

PersonSample::Truth truthOf(const PersonTruth& seen, const PinholeCamera& camera,
                            const Isometry3d& T_camera_world, const cv::Mat& person) {
  PersonSample::Truth truth;
  truth.pixels = seen.pixels;
  for (std::size_t j = 0; j < truth.joints.size(); ++j) {
    if (!seen.in_view[j]) continue;
    const Eigen::Vector2d& p = seen.joints_px[j];
    const int col = static_cast<int>(std::lround(p.x())),
              row = static_cast<int>(std::lround(p.y()));
    if (!seen.visible[j] && person.at<std::uint8_t>(row, col) != seen.id) continue;
    truth.joints[j] = {static_cast<float>(p.x()), static_cast<float>(p.y())};
    truth.states[j] = seen.visible[j] ? JointState::seen : JointState::behind;
  }
  const auto at = [&](Joint joint) { return seen.joints_world_m[index(joint)]; };
  const Vector3d middle =
      0.5 * at(Joint::neck) + 0.25 * (at(Joint::right_hip) + at(Joint::left_hip));
  const Vector3d p = T_camera_world * middle;
  if (p.z() < 0.15) return truth;
  const Eigen::Vector2d pixel = camera.project(p);
  truth.centre = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
  return truth;
}

/// One room with its people, from which pictures are taken.
class Studio {
 public:
  Studio(std::uint32_t seed, std::uint32_t room)
      : dice_(hash(seed, room)),
        room_(drawRoom(dice_)),
        walkway_(room_.world, 0.2),
        cast_(drawCast(2 + dice_.below(kSamplePeople - 1), dice_)),
        caster_(room_.world.mesh),
        renderer_(room_.world, caster_),
        people_(caster_, cast_, nothing_, 1) {}

  std::vector<PersonSample> samples() {
    std::vector<PersonSample> out;
    while (out.size() < kSamplesPerRoom) {
      const Arrangement arrangement = arrange(room_, walkway_, cast_, dice_);
      people_.pose({{arrangement.postures}});
      for (int i = 0; i < kCamerasPerArrangement; ++i) out.push_back(sample(arrangement));
    }
    return out;
  }

 private:
  PersonSample sample(const Arrangement& arrangement) {
    const PinholeCamera camera = drawCamera(dice_);
    Isometry3d view;
    for (int attempt = 0; attempt < 6; ++attempt) {
      view = drawView(room_, arrangement, dice_);
      const ViewSample from{view.linear().cast<float>(), view.translation().cast<float>(), 0.0F};
      renderer_.depth(camera, from, people_, view_);
      if (isWorthShowing(view_.depth_m)) break;
    }
    PersonSample out;
    const DepthConfig config = drawDepthConfig(kShrink, dice_);
    senseDepth({view_, camera, config, dice_.next()}, out.depth_mm, out.person);
    addFlaws(dice_, out.depth_mm);
    for (std::size_t i = 0; i < cast_.size(); ++i) {
      if (arrangement.present[i] == 0) continue;
      const auto joints = jointsOf(cast_[i].rig(), arrangement.postures[i]);
      const PersonTruth seen = observe(static_cast<int>(i), joints, camera, view, view_);
      if (seen.pixels > 0) {
        out.people[i] = truthOf(seen, camera, view.inverse(), view_.label);
      }
    }
    return out;
  }

  Dice dice_;
  PersonRoom room_;
  Walkway walkway_;
  std::vector<Avatar> cast_;
  RayCaster caster_;
  Renderer renderer_;
  const std::vector<ThingShape> nothing_;
  PosedMovers people_;
  DepthView view_;
};

void append(float value, std::vector<char>& bytes) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.insert(bytes.end(), raw, raw + sizeof value);
}

}  // namespace

std::vector<PersonSample> drawSamples(std::uint32_t seed, std::uint32_t room) {
  return Studio(seed, room).samples();
}

void appendBytes(const PersonSample& sample, std::vector<char>& bytes) {
  const auto* depth = reinterpret_cast<const char*>(sample.depth_mm.data);
  bytes.insert(bytes.end(), depth, depth + 2 * sample.depth_mm.total());
  const auto* person = reinterpret_cast<const char*>(sample.person.data);
  bytes.insert(bytes.end(), person, person + sample.person.total());
  for (const auto& truth : sample.people) {
    for (std::size_t j = 0; j < truth.joints.size(); ++j) {
      append(truth.joints[j].x, bytes);
      append(truth.joints[j].y, bytes);
      append(static_cast<float>(truth.states[j]), bytes);
    }
  }
  for (const auto& truth : sample.people) {
    append(truth.centre.x, bytes);
    append(truth.centre.y, bytes);
    append(static_cast<float>(truth.pixels), bytes);
  }
}

}  // namespace pf::simulator

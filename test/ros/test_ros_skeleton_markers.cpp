// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/skeleton_markers.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace posefusion_ros {
namespace {

constexpr std::uint16_t kPerson_mm = 2000, kWall_mm = 5000;

/// A person 2 m away before a wall at 5 m, joints all over the body.
struct Scene {
  pf::RgbdFrame frame;
  pf::People people;

  Scene() {
    frame.camera.width = 64;
    frame.camera.height = 48;
    frame.camera.fx = frame.camera.fy = 60;
    frame.camera.cx = 31.5;
    frame.camera.cy = 23.5;
    frame.depth = cv::Mat(48, 64, CV_16UC1, cv::Scalar(kPerson_mm));
    frame.depth_unit_m = 0.001;
    people.people.resize(1);
    std::size_t i = 0;
    for (auto& joint : people.people[0].joints) {
      joint.u = 25 + static_cast<float>(i % 4) * 3;
      joint.v = 10 + static_cast<float>(i / 4) * 3;
      joint.p = 1;
      ++i;
    }
  }

  std::vector<geometry_msgs::Point> lines() const {
    const auto markers = toMarkers(people, frame, {}).markers;
    return markers.size() < 2 ? std::vector<geometry_msgs::Point>() : markers[1].points;
  }
};

TEST(SkeletonMarkers, AllLimbsOfAPersonWithDepthAreDrawn) {
  EXPECT_EQ(Scene().lines().size(), 2 * pf::kSkeletonLines.size());
}

TEST(SkeletonMarkers, JointsWithTheDepthOfTheBackgroundAreLeftOut) {
  Scene scene;
  const auto& joints = scene.people.people[0].joints;
  const auto wrist = static_cast<std::size_t>(pf::kSkeletonLines.back().second);
  scene.frame.depth.at<std::uint16_t>(static_cast<int>(std::lround(joints[wrist].v)),
                                      static_cast<int>(std::lround(joints[wrist].u))) = kWall_mm;
  const auto lines = scene.lines();
  EXPECT_LT(lines.size(), 2 * pf::kSkeletonLines.size());
  EXPECT_GT(lines.size(), pf::kSkeletonLines.size());
  for (const auto& point : lines) EXPECT_NEAR(point.z, 2, 1e-6);
}

TEST(SkeletonMarkers, NoBoneIsLongerThanAPersonHasIt) {
  Scene scene;
  scene.people.people[0].joints[0].u = 63;  // a joint of another person: 1.1 m to the side
  const auto lines = scene.lines();
  EXPECT_LT(lines.size(), 2 * pf::kSkeletonLines.size());
  for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
    const auto &a = lines[i], &b = lines[i + 1];
    EXPECT_LT(std::hypot(a.x - b.x, a.y - b.y, a.z - b.z), 1.0);
  }
}

}  // namespace
}  // namespace posefusion_ros

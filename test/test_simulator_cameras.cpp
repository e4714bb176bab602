// SPDX-License-Identifier: BSD-3-Clause
// Cameras move as hands and robots do.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "simulator/camera_path.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

/// The largest over a while, at the rate of a motion capture.
struct Extremes {
  double speed_m_s = 0.0, turn_rad_s = 0.0, acceleration_m_s2 = 0.0;
};

Extremes extremesOf(const CameraPath& path, double duration_s) {
  constexpr double kStep_s = 0.005;
  Extremes most;
  Eigen::Isometry3d before = path.at(0.0);
  Eigen::Vector3d last = (path.at(kStep_s).translation() - before.translation()) / kStep_s;
  for (double t = kStep_s; t < duration_s; t += kStep_s) {
    const Eigen::Isometry3d now = path.at(t);
    EXPECT_NEAR(now.linear().determinant(), 1.0, 1e-6);
    const Eigen::Vector3d velocity = (now.translation() - before.translation()) / kStep_s;
    const double angle = Eigen::AngleAxisd(before.linear().transpose() * now.linear()).angle();
    most.speed_m_s = std::max(most.speed_m_s, velocity.norm());
    most.turn_rad_s = std::max(most.turn_rad_s, angle / kStep_s);
    most.acceleration_m_s2 = std::max(most.acceleration_m_s2, (velocity - last).norm() / kStep_s);
    before = now;
    last = velocity;
  }
  return most;
}

TEST(SimulatorCameras, HandHeldCamerasMoveSmoothly) {
  for (const char* pattern : {"static", "xyz", "rpy", "halfsphere"}) {
    HandHeld spec;
    spec.pattern = pattern;
    const auto path = makeHandHeld(spec, 5U);
    const Extremes most = extremesOf(*path, 30.0);
    EXPECT_LT(most.speed_m_s, 1.6) << pattern;
    EXPECT_LT(most.turn_rad_s, 2.0) << pattern;
    EXPECT_LT(most.acceleration_m_s2, 5.0) << pattern;
    const double still = (path->at(3.0).translation() - path->at(0.0).translation()).norm();
    if (std::string(pattern) == "static") {
      EXPECT_LT(still, 0.06);
    }
  }
}

TEST(SimulatorCameras, RobotsFallWhenTheScenarioHasItAndGetUpElsewhere) {
  Robot spec;
  spec.waypoints = {{1, 1}, {6, 1}, {6, 5}};
  spec.falls = {{9.0, "forward", 3.0, 0.8, 0.9}};
  const auto path = makeRobot(spec, 30.0, 3U);
  // A body that hits the floor is stopped within centimetres: some ten times gravity.
  const Extremes falling = extremesOf(*path, 30.0);
  EXPECT_LT(falling.speed_m_s, 6.0);
  EXPECT_LT(falling.turn_rad_s, 9.0);
  EXPECT_GT(falling.acceleration_m_s2, 60.0);
  EXPECT_LT(falling.acceleration_m_s2, 250.0);
  const Extremes walking = extremesOf(*path, 8.9);
  EXPECT_LT(walking.speed_m_s, 0.6);
  EXPECT_LT(walking.turn_rad_s, 2.0);
  EXPECT_GT(walking.acceleration_m_s2, 5.0);
  EXPECT_LT(walking.acceleration_m_s2, 30.0);
  ASSERT_EQ(path->events().size(), 1U);
  const Event fall = path->events()[0];
  EXPECT_EQ(fall.kind, "fall");
  EXPECT_NEAR(fall.start_s, 9.0, 0.8);
  EXPECT_NEAR(path->at(fall.start_s - 0.1).translation().z(), spec.height_m, 0.05);
  EXPECT_LT(path->at(fall.start_s + 2.0).translation().z(), 0.35);
  const Eigen::Isometry3d before = path->at(fall.start_s - 0.1), after = path->at(fall.end_s + 0.2);
  EXPECT_NEAR(after.translation().z(), spec.height_m, 0.05);
  EXPECT_GT((after.translation() - before.translation()).norm(), 0.5);
  EXPECT_GT(std::acos(before.linear().col(2).dot(after.linear().col(2))), 0.6);
}

TEST(SimulatorCameras, RobotsFallDownStairsAndGetUpBelow) {
  Robot spec;
  spec.waypoints = {{1, 1}, {6, 1}, {6, 5}};
  spec.floor_m = 0.68;
  Fall fall;
  fall.at_s = 9.0;
  fall.down_m = 0.68;
  fall.ahead_m = 1.6;
  fall.drop_s = 0.7;
  fall.bumps = 3;
  fall.skip_m = 2.2;
  spec.falls = {fall};
  const auto path = makeRobot(spec, 30.0, 3U);
  ASSERT_EQ(path->events().size(), 1U);
  const Event event = path->events()[0];
  const Eigen::Vector3d before = path->at(event.start_s - 0.1).translation(),
                        lying = path->at(event.start_s + 3.0).translation(),
                        after = path->at(event.end_s + 0.2).translation();
  EXPECT_NEAR(before.z(), 0.68 + spec.height_m, 0.05);
  EXPECT_NEAR(lying.z(), 0.24, 0.05);
  EXPECT_NEAR(lying.x() - before.x(), 1.6, 0.1);
  EXPECT_NEAR(after.z(), spec.height_m, 0.05);
  EXPECT_NEAR(after.x() - before.x(), 2.2, 0.15);
  EXPECT_NEAR(path->at(29.0).translation().z(), spec.height_m, 0.05);
  const Extremes falling = extremesOf(*path, 30.0);
  EXPECT_LT(falling.speed_m_s, 8.0);
  EXPECT_LT(falling.turn_rad_s, 12.0);
  EXPECT_GT(falling.acceleration_m_s2, 60.0);
  EXPECT_LT(falling.acceleration_m_s2, 300.0);
}

TEST(SimulatorCameras, RobotsFaceTheGivenDirection) {
  Robot spec;
  spec.waypoints = {{1, 1}, {Vector2d(5, 1), -M_PI_2}, {5, 3}};
  spec.repeats = false;
  const auto path = makeRobot(spec, 60.0, 3U);
  int sideways = 0, ahead = 0;
  for (double t = 0.0; t < 40.0; t += 0.1) {
    const Eigen::Vector3d at = path->at(t).translation(), axis = path->at(t).linear().col(2);
    if (at.x() > 1.3 && at.x() < 4.7) {
      EXPECT_LT(axis.y(), -0.95) << t;
      ++sideways;
    }
    ahead += at.y() > 1.3 && axis.y() > 0.9 ? 1 : 0;
  }
  EXPECT_GT(sideways, 50);
  EXPECT_GT(ahead, 10);
}

}  // namespace
}  // namespace pf::simulator

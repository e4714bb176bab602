// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/recent_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pf {
namespace {

constexpr double kDistance_m = 2.0;

/// A twist (m/s, rad/s) that goes on for so long.
void move(RecentMotion& motion, const Vector6d& speed, double seconds, double rate_hz) {
  const auto frames = static_cast<int>(seconds * rate_hz);
  for (int i = 0; i < frames; ++i) motion.add(expSe3(speed / rate_hz), 1.0 / rate_hz);
}

Vector6d turning(double rad_s) {
  Vector6d speed = Vector6d::Zero();
  speed[4] = rad_s;
  return speed;
}

PinholeCamera camera() {
  PinholeCamera camera;
  camera.width = camera.height = 100;
  camera.fx = camera.fy = 50 / std::tan(0.5);  // a view of one rad
  return camera;
}

TEST(RecentMotion, AtRestNothingIsNew) {
  RecentMotion motion;
  move(motion, Vector6d::Zero(), 1.0, 30.0);
  EXPECT_EQ(motion.newView(camera(), kDistance_m), 0.0);
}

TEST(RecentMotion, WhatIsNewIsWhatASecondBringsAtAnyRateOfFrames) {
  for (const double rate_hz : {10.0, 30.0, 60.0}) {
    RecentMotion turns, walks;
    Vector6d ahead = Vector6d::Zero();
    ahead[2] = 0.8;
    move(turns, turning(0.4), 8.0, rate_hz);
    move(walks, ahead, 8.0, rate_hz);
    EXPECT_NEAR(turns.newView(camera(), kDistance_m), 0.4, 0.03) << rate_hz;
    EXPECT_NEAR(walks.newView(camera(), kDistance_m), 0.4, 0.03) << rate_hz;
    EXPECT_NEAR(walks.newView(camera(), 2.0 * kDistance_m), 0.2, 0.02) << rate_hz;
  }
}

TEST(RecentMotion, WhatTheCameraComesBackToIsNotNew) {
  RecentMotion motion;
  for (int i = 0; i < 60; ++i) motion.add(expSe3(turning(i % 2 == 0 ? 0.1 : -0.1)), 1.0 / 30.0);
  EXPECT_LT(motion.newView(camera(), kDistance_m), 0.06);
}

TEST(RecentMotion, ItFadesAtRest) {
  RecentMotion motion;
  move(motion, turning(0.4), 8.0, 30.0);
  move(motion, Vector6d::Zero(), 5.0, 30.0);
  EXPECT_LT(motion.newView(camera(), kDistance_m), 0.01);
}

}  // namespace
}  // namespace pf

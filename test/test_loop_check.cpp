// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/core/se3.hpp"
#include "posefusion/evaluation/loop_check.hpp"
#include "random_pose.hpp"

namespace pf {
namespace {

Vector6d twist(double x, double y, double z, double a, double b, double c) {
  Vector6d v;
  v << x, y, z, a, b, c;
  return v;
}

/// A camera that walks and turns, a true pose each 10 ms, keyframes between them in time.
struct LoopWalk {
  Trajectory truth;
  std::vector<Keyframe> keyframes;

  LoopWalk() {
    const Vector6d speed = twist(0.002, 0.0005, 0.004, 0.001, 0.003, -0.001);
    for (int i = 0; i < 100; ++i) truth.push_back({i * 10 * kMs, expSe3(i * speed)});
    for (int i = 0; i < 5; ++i) {
      Keyframe keyframe;
      keyframe.id = i;
      keyframe.stamp_ns = i * 200 * kMs;
      keyframes.push_back(keyframe);
    }
  }

  Eigen::Isometry3d motion(int from, int to) const {
    const auto at = [&](int k) { return truth[static_cast<std::size_t>(20 * k)].T_world_camera; };
    return at(from).inverse() * at(to);
  }

  PoseConstraint loop(int from, int to, const Vector6d& error) const {
    PoseConstraint c;
    c.from = from;
    c.to = to;
    c.T_from_to = motion(from, to) * expSe3(error);
    return c;
  }
};

TEST(LoopCheck, MeasuresJustTheErrorOfALoop) {
  const LoopWalk walk;
  const auto errors =
      checkLoops(walk.truth, walk.keyframes,
                 {walk.loop(0, 3, Vector6d::Zero()), walk.loop(4, 1, twist(0.03, 0, 0.04, 0, 0, 0)),
                  walk.loop(1, 3, twist(0, 0, 0, 0, 0.02, 0))});
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_NEAR(errors[0].shift_m, 0, 1e-9);
  EXPECT_NEAR(errors[0].turn_deg, 0, 1e-6);
  EXPECT_EQ(errors[1].from, 4);
  EXPECT_EQ(errors[1].to, 1);
  EXPECT_NEAR(errors[1].shift_m, 0.05, 1e-9);
  EXPECT_NEAR(errors[2].turn_deg, 0.02 * 180 / M_PI, 1e-6);
  for (const LoopError& error : errors) EXPECT_FALSE(error.isWrong());
}

TEST(LoopCheck, WrongIsEitherTooFarOrTurnedTooFar) {
  const LoopWalk walk;
  const auto errors = checkLoops(
      walk.truth, walk.keyframes,
      {walk.loop(0, 3, twist(0.11, 0, 0, 0, 0, 0)), walk.loop(0, 3, twist(0, 0, 0, 0.06, 0, 0)),
       walk.loop(0, 3, twist(0.09, 0, 0, 0, 0.05, 0))});
  ASSERT_EQ(errors.size(), 3U);
  EXPECT_TRUE(errors[0].isWrong());
  EXPECT_TRUE(errors[1].isWrong());
  EXPECT_FALSE(errors[2].isWrong());
}

TEST(LoopCheck, StepsAndKeyframesWithoutTruthAreLeftOut) {
  LoopWalk walk;
  PoseConstraint step = walk.loop(0, 1, twist(1, 0, 0, 0, 0, 0));
  step.kind = ConstraintKind::odometry;
  walk.keyframes[2].stamp_ns = 5000 * kMs;
  const auto errors =
      checkLoops(walk.truth, walk.keyframes,
                 {step, walk.loop(0, 2, Vector6d::Zero()), walk.loop(0, 3, Vector6d::Zero())});
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].to, 3);
}

}  // namespace
}  // namespace pf

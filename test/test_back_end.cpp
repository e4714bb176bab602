// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/back_end.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

Eigen::Isometry3d along(double x_m, double turn_rad = 0) {
  Eigen::Isometry3d T(Eigen::Translation3d(x_m, 0, 0));
  T.linear() = expSo3({0, turn_rad, 0});
  return T;
}

FusedFrame fusedAt(int number, const Eigen::Isometry3d& T) {
  FusedFrame frame;
  frame.stamp_ns = number;
  frame.map_frame = number;
  frame.pose.T_map_camera = T;
  frame.covariance = 1e-6 * Matrix6d::Identity();
  return frame;
}

TEST(BackEnd, MakesAKeyframeOfWhatMovedOrTurned) {
  BackEnd back_end{GraphConfig{}};
  EXPECT_EQ(back_end.add(fusedAt(0, along(0))), 0);
  EXPECT_EQ(back_end.add(fusedAt(1, along(0.2))), -1);
  EXPECT_EQ(back_end.add(fusedAt(2, along(0.35))), 1);
  EXPECT_EQ(back_end.add(fusedAt(3, along(0.36, 0.2))), -1);
  EXPECT_EQ(back_end.add(fusedAt(4, along(0.36, 0.3))), 2);
  EXPECT_EQ(back_end.graph().constraints().size(), 2U);
}

TEST(BackEnd, AStepLeadsOnIntoWhatNoOtherKeyframeSeesFromNearer) {
  BackEnd back_end{GraphConfig{}};
  for (int i = 0; i < 4; ++i) back_end.add(fusedAt(i, along(0.5 * i)));
  EXPECT_FALSE(back_end.stepTo(0));
  const auto step = back_end.stepTo(3);
  ASSERT_TRUE(step);
  EXPECT_EQ(step->from, 2);
  EXPECT_EQ(step->to, 3);
  ASSERT_EQ(back_end.add(fusedAt(4, along(0.95))), 4);
  EXPECT_FALSE(back_end.stepTo(4)) << "keyframe 2 is nearer than the last";
  FusedFrame found = fusedAt(5, along(1.1));
  found.is_return = true;
  ASSERT_EQ(back_end.add(found), 5);
  EXPECT_FALSE(back_end.stepTo(5)) << "a return was not tracked";
}

TEST(BackEnd, AReturnIsTiedToTheNearestKeyframe) {
  BackEnd back_end{GraphConfig{}};
  for (int i = 0; i < 6; ++i) back_end.add(fusedAt(i, along(0.5 * i)));
  FusedFrame found = fusedAt(9, along(1.05));
  found.is_return = true;
  EXPECT_EQ(back_end.add(found), 6) << "a keyframe, however near";
  const PoseConstraint& tie = back_end.graph().constraints().back();
  EXPECT_EQ(tie.from, 2);
  EXPECT_EQ(tie.to, 6);
}

TEST(BackEnd, AReturnIntoAnOlderFragmentIsTiedToThat) {
  BackEnd back_end{GraphConfig{}};
  const auto fusedIn = [](int fragment, int number, double x_m) {
    FusedFrame frame = fusedAt(number, along(x_m));
    frame.pose.fragment = fragment;
    return frame;
  };
  for (int i = 0; i < 3; ++i) back_end.add(fusedIn(0, i, 0.5 * i));
  for (int i = 3; i < 6; ++i) back_end.add(fusedIn(1, i, 0.5 * (i - 3)));
  EXPECT_EQ(back_end.graph().constraints().size(), 4U) << "the first of a fragment is tied to none";
  EXPECT_EQ(back_end.nearest({0, along(0.9)}), 2);
  EXPECT_EQ(back_end.nearest({1, along(0.9)}), 5);
  EXPECT_EQ(back_end.nearest({2, along(0.9)}), -1);
  FusedFrame found = fusedIn(0, 9, 0.45);
  found.is_return = true;
  EXPECT_EQ(back_end.add(found), 6);
  EXPECT_EQ(back_end.graph().constraints().back().from, 1);
  found = fusedIn(1, 12, 0.05);
  found.is_return = true;
  EXPECT_EQ(back_end.add(found), 7);
  EXPECT_EQ(back_end.graph().constraints().back().from, 3);
  back_end.record(100, {0, along(0.4)});
  back_end.record(101, {1, along(0.1)});
  EXPECT_EQ(back_end.frames()[0].pose.keyframe, 6) << "by a keyframe of its fragment";
  EXPECT_EQ(back_end.frames()[1].pose.keyframe, 7);
  ASSERT_EQ(back_end.trajectory().size(), 1U);
  EXPECT_NEAR(back_end.trajectory()[0].T_world_camera.translation().x(), 0.4, 1e-12);
}

/// Closes loops as they are closed beside mapping; returns what the map is to follow.
std::vector<Deformation> close(BackEnd& back_end, const std::vector<PoseConstraint>& loops) {
  PoseGraph graph = back_end.handOver();
  const ClosedLoops closed = graph.close(loops);
  return back_end.takeUp(std::move(graph), closed);
}

/// A circle with a drift of 0.24 m: the camera is lost as it comes home and relocalised at the
/// first keyframe; its corners give the motion in between.
FusedFrame homeAfterARound(BackEnd& back_end) {
  constexpr double kDrift_m = 0.24;
  constexpr int kSteps = 20;
  for (int i = 0; i < kSteps; ++i) {
    const double part = static_cast<double>(i) / kSteps;
    const double angle = 2 * M_PI * part;
    const Eigen::Translation3d place(1.5 * (std::cos(angle) - 1) + part * kDrift_m, 0,
                                     1.5 * std::sin(angle));
    back_end.add(fusedAt(i, Eigen::Isometry3d(place)));
  }
  FusedFrame home = fusedAt(30, along(0));
  home.is_return = true;
  home.carried.T_map_camera = along(kDrift_m);
  home.carried.covariance = 1e-4 * Matrix6d::Identity();
  home.carried.is_measured = true;
  return home;
}

TEST(BackEnd, AReturnClosesALoopByTheWayThroughTheLoss) {
  BackEnd back_end{GraphConfig{}};
  const FusedFrame home = homeAfterARound(back_end);
  const auto before = back_end.keyframePoses();
  const int id = back_end.add(home);
  EXPECT_EQ(back_end.keyframePoses()[19].T_map_camera.matrix(), before[19].T_map_camera.matrix())
      << "it waits";
  ASSERT_EQ(close(back_end, {}).size(), 1U);
  const Eigen::Isometry3d came = before[19].T_map_camera.inverse() * home.carried.T_map_camera;
  const auto after = back_end.keyframePoses();
  const Eigen::Isometry3d off =
      (after[19].T_map_camera * came).inverse() * after[static_cast<std::size_t>(id)].T_map_camera;
  EXPECT_LT(off.translation().norm(), 0.05) << "0.24 m before";
}

TEST(BackEnd, AWayThatIsNotMeasuredOrLeadsElsewhereClosesNothing) {
  for (const bool measured : {false, true}) {
    BackEnd back_end{GraphConfig{}};
    FusedFrame home = homeAfterARound(back_end);
    home.carried.is_measured = measured;
    if (measured) home.carried.T_map_camera = along(6.0);  // too far for a walk during a loss
    const auto before = back_end.keyframePoses();
    back_end.add(home);
    EXPECT_TRUE(close(back_end, {}).empty());
    const auto after = back_end.keyframePoses();
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(after[i].T_map_camera.matrix(), before[i].T_map_camera.matrix());
    }
    EXPECT_EQ(back_end.counts().refused, measured ? 1U : 0U);
  }
}

TEST(BackEnd, PosesFollowTheirKeyframes) {
  // Ten steps of half a metre that were measured 2 cm too long each; the last keyframe sees that it
  // is a full 4.5 m from the first.
  BackEnd back_end{GraphConfig{}};
  for (int i = 0; i < 10; ++i) {
    back_end.add(fusedAt(2 * i, along(0.52 * i)));
    back_end.record(2 * i, {0, along(0.52 * i)});
    back_end.record(2 * i + 1, {0, along(0.52 * i + 0.1)});
  }
  EXPECT_NEAR(back_end.trajectory().back().T_world_camera.translation().x(), 4.78, 1e-9);
  LoopConstraint loop;
  loop.from = 0;
  loop.to = 9;
  loop.T_from_to = along(4.5);
  loop.covariance = 1e-6 * Matrix6d::Identity();
  const std::vector<Deformation> result = close(back_end, {loop.asPoseConstraint()});
  ASSERT_EQ(result.size(), 1U);
  EXPECT_EQ(back_end.counts().accepted, 1U);
  const Trajectory poses = back_end.trajectory();
  ASSERT_EQ(poses.size(), 20U);
  EXPECT_NEAR(poses[18].T_world_camera.translation().x(), 4.5, 0.03);
  for (std::size_t i = 0; i + 1 < poses.size(); i += 2) {
    const Eigen::Isometry3d step = poses[i].T_world_camera.inverse() * poses[i + 1].T_world_camera;
    EXPECT_NEAR(step.translation().x(), 0.1, 1e-9) << "a frame keeps its place by its keyframe";
  }
}

TEST(BackEnd, KeepsNothingBeforeTheFirstKeyframe) {
  BackEnd back_end{GraphConfig{}};
  back_end.record(1, {0, along(0)});
  EXPECT_TRUE(back_end.trajectory().empty());
  EXPECT_TRUE(close(back_end, {}).empty());
}

}  // namespace
}  // namespace pf

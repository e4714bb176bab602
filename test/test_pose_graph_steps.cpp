// SPDX-License-Identifier: BSD-3-Clause
// Steps of tracking that pictures measure again.
#include "graph_scene.hpp"

namespace pf {
namespace {

PoseConstraint stepOf(const Poses& truth, int from) {
  PoseConstraint step = loopOf(truth, from, from + 1);
  step.kind = ConstraintKind::odometry;
  return step;
}

TEST(PoseGraphSteps, TrackingThatDriftsIsPutRightStepByStep) {
  const Poses truth = figureEight();
  const Poses tracked = drifted(truth, kYawDrift);
  ASSERT_GT(distance(tracked.back(), truth.back()), 0.03);
  PoseGraph graph((GraphConfig()));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (i == 0) {
      graph.addKeyframe(keyframeAt(truth[0], 0));
      continue;
    }
    const Eigen::Isometry3d last = graph.keyframes().back().T_map_camera;
    const Eigen::Isometry3d tracked_step = tracked[i - 1].inverse() * tracked[i];
    graph.addKeyframe(keyframeAt(last * tracked_step, i), static_cast<int>(i) - 1, kTracking);
    EXPECT_TRUE(graph.retrack(stepOf(truth, static_cast<int>(i) - 1)).accepted);
  }
  EXPECT_LT(worstDistance(graph, truth), 1e-9);
}

TEST(PoseGraphSteps, WhatHangsOnAStepMovesRigidlyAndNothingElse) {
  const Poses truth = corridor();
  const PoseGraph before = graphOf(drifted(truth, kYawDrift));
  PoseGraph graph = before;
  const GraphResult result = graph.retrack(stepOf(truth, 20));
  ASSERT_TRUE(result.accepted);
  EXPECT_EQ(graph.constraints().size(), before.constraints().size());
  const auto pose = [](const PoseGraph& g, std::size_t i) { return g.keyframes()[i].T_map_camera; };
  const Eigen::Isometry3d T_new_old = pose(graph, 21) * pose(before, 21).inverse();
  EXPECT_TRUE((pose(graph, 20).inverse() * pose(graph, 21))
                  .isApprox(truth[20].inverse() * truth[21], 1e-12));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto frame = static_cast<std::int32_t>(i) * kFramesApart;
    if (i <= 20) {
      EXPECT_EQ(pose(graph, i).matrix(), pose(before, i).matrix());
      EXPECT_EQ(result.deformation.at(frame).matrix(), Eigen::Isometry3d::Identity().matrix());
    } else {
      EXPECT_TRUE(pose(graph, i).isApprox(T_new_old * pose(before, i), 1e-12)) << i;
      EXPECT_TRUE((result.deformation.at(frame) * pose(before, i)).isApprox(pose(graph, i), 1e-12));
    }
  }
  EXPECT_EQ(result.deformation.firstMoved(0), 20 * kFramesApart + 1);
}

TEST(PoseGraphSteps, AStepThatLoopsLeadPastWaitsForTheSolver) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  graph.addLoop(loopOf(truth, 15, 44));
  ASSERT_TRUE(graph.optimise().accepted);
  const PoseGraph before = graph;
  EXPECT_FALSE(graph.retrack(stepOf(truth, 20)).accepted);
  expectUnchanged(graph, before);
  EXPECT_TRUE(graph.retrack(stepOf(truth, 44)).accepted) << "the loop ends before it";
}

TEST(PoseGraphSteps, PicturesThatContradictTrackingAreRejected) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(truth);
  const PoseGraph before = graph;
  PoseConstraint step = stepOf(truth, 20);
  step.T_from_to = step.T_from_to * motion(0.5, 0, 0, 0);
  const GraphResult result = graph.retrack(step);
  EXPECT_FALSE(result.accepted);
  EXPECT_NE(result.reason.find("contradict"), std::string::npos);
  expectUnchanged(graph, before);
}

TEST(PoseGraphSteps, AStepThatIsNoneIsLeftOut) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(truth);
  const PoseGraph before = graph;
  EXPECT_FALSE(graph.retrack(loopOf(truth, 3, 9)).accepted);
  EXPECT_FALSE(graph
                   .retrack([&] {
                     PoseConstraint beyond = loopOf(truth, 3, 9);
                     beyond.to = 60;
                     return beyond;
                   }())
                   .accepted);
  expectUnchanged(graph, before);
}

TEST(PoseGraphSteps, OtherFragmentsStay) {
  const Poses truth = corridor();
  PoseGraph graph = twoFragments(truth);
  const PoseGraph before = graph;
  PoseConstraint step = stepOf(truth, 20);
  step.T_from_to = step.T_from_to * motion(0.01, 0, 0, 0);
  ASSERT_TRUE(graph.retrack(step).accepted);
  for (std::size_t i = 30; i < truth.size(); ++i) {
    EXPECT_EQ(graph.keyframes()[i].T_map_camera.matrix(),
              before.keyframes()[i].T_map_camera.matrix());
  }
  EXPECT_GT(distance(graph.keyframes()[29].T_map_camera, before.keyframes()[29].T_map_camera),
            0.005);
}

}  // namespace
}  // namespace pf

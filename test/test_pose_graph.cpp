// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "graph_scene.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

TEST(PoseGraph, StraightensABentCorridor) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  EXPECT_GT(worstDistance(graph, truth), 0.5);
  graph.addLoop(loopOf(truth, 0, 59));
  graph.addLoop(loopOf(truth, 15, 44));
  const GraphResult result = graph.optimise();
  ASSERT_TRUE(result.accepted) << result.reason;
  EXPECT_TRUE(result.refused.empty());
  EXPECT_LT(worstDistance(graph, truth), 0.1);
  EXPECT_EQ(graph.version(), 1);
  EXPECT_EQ(result.deformation.version(), 1);
  ASSERT_EQ(result.errors.size(), 61U);
  EXPECT_GT(result.errors[59].before, 100);
  EXPECT_LT(result.errors[59].after, 5);
  EXPECT_EQ(graph.keyframes()[0].T_map_camera.matrix(), truth[0].matrix());
}

TEST(PoseGraph, ClosesAFigureEight) {
  const Poses truth = figureEight();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  EXPECT_GT(distance(graph.keyframes()[40].T_map_camera, truth[40]), 0.15);
  graph.addLoop(loopOf(truth, 0, 40));
  ASSERT_TRUE(graph.optimise().accepted);
  graph.addLoop(loopOf(truth, 0, 80));
  ASSERT_TRUE(graph.optimise().accepted);
  EXPECT_LT(distance(graph.keyframes()[40].T_map_camera, truth[40]), 0.02);
  EXPECT_LT(distance(graph.keyframes()[80].T_map_camera, truth[80]), 0.02);
  EXPECT_LT(worstDistance(graph, truth), 0.15);
  EXPECT_EQ(graph.version(), 2);
}

TEST(PoseGraph, TheDeformationMovesKeyframesAsTheGraphDoes) {
  const Poses truth = corridor();
  const PoseGraph before = graphOf(drifted(truth, kYawDrift));
  PoseGraph graph = before;
  graph.addLoop(loopOf(truth, 0, 59));
  const GraphResult result = graph.optimise();
  ASSERT_TRUE(result.accepted);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Isometry3d moved =
        result.deformation.at(before.keyframes()[i].map_frame) * before.keyframes()[i].T_map_camera;
    EXPECT_TRUE(moved.isApprox(graph.keyframes()[i].T_map_camera, 1e-9)) << i;
  }
  for (int frame = 1; frame < 590; ++frame) {  // no jump anywhere between
    const Eigen::Isometry3d step =
        result.deformation.at(frame - 1).inverse() * result.deformation.at(frame);
    EXPECT_LT(logSe3(step).norm(), 0.02) << frame;
  }
}

TEST(PoseGraph, ChangesNothingBeforeALoopAndRigidlyWhatFollowsIt) {
  const Poses truth = corridor();
  const PoseGraph before = graphOf(drifted(truth, kYawDrift));
  PoseGraph graph = before;
  graph.addLoop(loopOf(truth, 15, 44));
  ASSERT_TRUE(graph.optimise().accepted);
  for (std::size_t i = 0; i <= 15; ++i) {
    EXPECT_EQ(graph.keyframes()[i].T_map_camera.matrix(),
              before.keyframes()[i].T_map_camera.matrix());
  }
  EXPECT_GT(distance(graph.keyframes()[30].T_map_camera, before.keyframes()[30].T_map_camera),
            0.01);
  const auto motionFrom44 = [](const PoseGraph& g) {
    return g.keyframes()[44].T_map_camera.inverse() * g.keyframes()[59].T_map_camera;
  };
  EXPECT_TRUE(motionFrom44(graph).isApprox(motionFrom44(before), 1e-6));
}

TEST(PoseGraph, WithoutNewLoopsNothingHappens) {
  const PoseGraph before = graphOf(corridor());
  PoseGraph graph = before;
  const GraphResult result = graph.optimise();
  EXPECT_FALSE(result.accepted);
  EXPECT_TRUE(result.deformation.isIdentity());
  expectUnchanged(graph, before);
}

TEST(PoseGraph, LoopsThatOnlyConfirmHoldAndMoveNothing) {
  const Poses truth = corridor();
  const PoseGraph before = graphOf(truth);
  PoseGraph graph = before;
  for (const int to : {55, 59}) {
    PoseConstraint loop = loopOf(truth, 0, to);
    loop.T_from_to = loop.T_from_to * motion(0.5 * graph.config().loop_sigma_m, 0, 0, 0);
    graph.addLoop(loop);
  }
  const GraphResult result = graph.optimise();
  EXPECT_FALSE(result.accepted) << "no correction";
  EXPECT_TRUE(result.refused.empty());
  EXPECT_TRUE(result.deformation.isIdentity());
  EXPECT_EQ(graph.version(), before.version());
  EXPECT_EQ(graph.constraints().size(), before.constraints().size() + 2);
  EXPECT_EQ(worstDistance(graph, truth), 0);
  // A loop that is not met, but too uncertain to move anything by more than the error of a loop.
  PoseConstraint unsure = loopOf(truth, 30, 33);
  unsure.T_from_to = unsure.T_from_to * motion(1.5 * graph.config().loop_sigma_m, 0, 0, 0);
  unsure.covariance = Matrix6d::Identity() * 0.0025;
  graph.addLoop(unsure);
  EXPECT_FALSE(graph.optimise().accepted);
  EXPECT_EQ(graph.constraints().size(), before.constraints().size() + 3);
  EXPECT_EQ(worstDistance(graph, truth), 0);
  // With a loop that is not met, all loops count.
  PoseConstraint loop = loopOf(truth, 0, 58);
  loop.T_from_to = loop.T_from_to * motion(3 * graph.config().loop_sigma_m, 0, 0, 0);
  graph.addLoop(loop);
  graph.addLoop(loopOf(truth, 1, 57));
  EXPECT_TRUE(graph.optimise().accepted);
  EXPECT_EQ(graph.constraints().size(), before.constraints().size() + 5);
}

TEST(PoseGraph, RefusesAFalseLoopAndUndoesIt) {
  const Poses truth = corridor();
  const PoseGraph before = graphOf(drifted(truth, kYawDrift));
  for (const auto& wrong : {motion(3, 0, 0, 0), motion(0, 0, 0, 1.5), motion(0, 2.5, 1, -0.5)}) {
    PoseGraph graph = before;
    PoseConstraint loop = loopOf(truth, 0, 59);
    loop.T_from_to = loop.T_from_to * wrong;
    graph.addLoop(loop);
    const GraphResult result = graph.optimise();
    EXPECT_FALSE(result.accepted);
    ASSERT_EQ(result.refused.size(), 1U);
    EXPECT_EQ(result.refused[0].constraint.to, 59);
    EXPECT_EQ(result.refused[0].reason, result.reason);
    EXPECT_NE(result.reason.find("chi-square"), std::string::npos);
    EXPECT_TRUE(result.deformation.isIdentity());
    expectUnchanged(graph, before);
    EXPECT_FALSE(graph.optimise().accepted) << "it is forgotten";
  }
}

TEST(PoseGraph, ASmallFalseLoopIsRefusedWhereTrueOnesHold) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  for (const auto& [a, b] : {std::pair{0, 59}, {10, 49}, {20, 39}})
    graph.addLoop(loopOf(truth, a, b));
  ASSERT_TRUE(graph.optimise().accepted);
  const PoseGraph before = graph;
  PoseConstraint loop = loopOf(truth, 9, 50);
  loop.T_from_to = loop.T_from_to * motion(0.3, 0, 0, 0);
  graph.addLoop(loop);
  EXPECT_FALSE(graph.optimise().accepted);
  expectUnchanged(graph, before);
}

TEST(PoseGraph, KeepsTheTrueLoopsBesideAFalseOne) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  graph.addLoop(loopOf(truth, 0, 59));
  PoseConstraint wrong = loopOf(truth, 10, 49);
  wrong.T_from_to = wrong.T_from_to * motion(1.5, 0, 0, 0.4);
  graph.addLoop(wrong);
  graph.addLoop(loopOf(truth, 20, 39));
  const GraphResult result = graph.optimise();
  ASSERT_TRUE(result.accepted) << result.reason;
  ASSERT_EQ(result.refused.size(), 1U);
  EXPECT_EQ(result.refused[0].constraint.from, 10);
  EXPECT_EQ(graph.constraints().size(), 59U + 2U);
  EXPECT_LT(worstDistance(graph, truth), 0.1);
}

TEST(PoseGraph, MovingTheWorldMovesTheAnswer) {
  const Eigen::Isometry3d world = motion(4, -2, 7, 2.0, 0.7);
  const Poses truth = figureEight();
  Poses here = drifted(truth, kYawDrift), there = here;
  for (auto& T : there) T = world * T;
  PoseGraph one = graphOf(here), other = graphOf(there);
  for (PoseGraph* graph : {&one, &other}) {
    graph->addLoop(loopOf(truth, 0, 80));
    ASSERT_TRUE(graph->optimise().accepted);
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_TRUE(
        other.keyframes()[i].T_map_camera.isApprox(world * one.keyframes()[i].T_map_camera, 1e-6))
        << i;
  }
}

TEST(PoseGraph, IsTheSameToTheBitEachTime) {
  const Poses truth = figureEight();
  const auto run = [&] {
    PoseGraph graph = graphOf(drifted(truth, kYawDrift));
    for (const auto& [a, b] : {std::pair{0, 80}, {0, 40}, {5, 79}})
      graph.addLoop(loopOf(truth, a, b));
    EXPECT_TRUE(graph.optimise().accepted);
    return graph;
  };
  const PoseGraph one = run();
  for (int i = 0; i < 3; ++i) expectUnchanged(run(), one);
}

TEST(PoseGraph, PosesOfFramesFollowTheirKeyframe) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  const RelativePose frame{50, motion(0.1, 0.2, 0.3, 0.4)};
  graph.addLoop(loopOf(truth, 0, 59));
  ASSERT_TRUE(graph.optimise().accepted);
  const Eigen::Isometry3d expected = graph.keyframes()[50].T_map_camera * frame.T_keyframe_camera;
  EXPECT_EQ(graph.poseOf(frame).matrix(), expected.matrix());
}

TEST(PoseGraph, RefusesWhatNoGraphCanHold) {
  const Poses truth = corridor();
  PoseGraph graph = twoFragments(truth);
  const auto refused = [&](const PoseConstraint& loop) {
    EXPECT_THROW(graph.addLoop(loop), std::invalid_argument);
  };
  refused(loopOf(truth, 3, 3));
  refused(loopOf(truth, 12, 40));  // another fragment
  PoseConstraint loop = loopOf(truth, 0, 20);
  loop.to = 60;
  refused(loop);
  loop = loopOf(truth, 0, 20);
  loop.covariance(0, 0) = std::nan("");
  refused(loop);
  loop = loopOf(truth, 0, 20);
  loop.covariance = -Matrix6d::Identity();
  refused(loop);
  loop = loopOf(truth, 0, 20);
  loop.T_from_to.translation().x() = INFINITY;
  refused(loop);
  EXPECT_THROW(graph.joinFragment(loopOf(truth, 0, 20)), std::invalid_argument);
  EXPECT_THROW(graph.addKeyframe(keyframeAt(truth[0], 60), 60, kTracking), std::invalid_argument);
  EXPECT_EQ(graph.keyframes().size(), 60U);
}

TEST(PoseGraph, GoesOnFromWhatWasSaved) {
  const Poses truth = figureEight();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  graph.addLoop(loopOf(truth, 0, 40));
  ASSERT_TRUE(graph.optimise().accepted);
  PoseGraph restored(graph.config(), graph.keyframes(), graph.constraints(), graph.version());
  for (PoseGraph* g : {&graph, &restored}) {
    g->addLoop(loopOf(truth, 0, 80));
    ASSERT_TRUE(g->optimise().accepted);
  }
  expectUnchanged(restored, graph);
}

TEST(PoseGraph, DoesNotTakeUpABrokenOne) {
  const PoseGraph graph = graphOf(corridor());
  auto keyframes = graph.keyframes();
  auto constraints = graph.constraints();
  keyframes[4].id = 7;
  EXPECT_THROW(PoseGraph({}, keyframes, constraints, 0), InputError);
  keyframes = graph.keyframes();
  keyframes[4].T_map_camera.linear() *= 1.1;
  EXPECT_THROW(PoseGraph({}, keyframes, constraints, 0), InputError);
  keyframes = graph.keyframes();
  constraints[4].to = 1000;
  EXPECT_THROW(PoseGraph({}, keyframes, constraints, 0), InputError);
  EXPECT_THROW(PoseGraph({}, keyframes, graph.constraints(), -1), InputError);
}

}  // namespace
}  // namespace pf

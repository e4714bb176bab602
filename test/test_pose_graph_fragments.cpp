// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <utility>

#include "graph_scene.hpp"

namespace pf {
namespace {

TEST(PoseGraphFragments, JoinsALaterFragmentRigidly) {
  const Poses truth = corridor();
  for (const bool backwards : {false, true}) {
    PoseGraph graph = twoFragments(truth);
    const PoseConstraint loop = backwards ? loopOf(truth, 40, 12) : loopOf(truth, 12, 40);
    const GraphResult result = graph.joinFragment(loop);
    ASSERT_TRUE(result.accepted) << result.reason;
    EXPECT_LT(worstDistance(graph, truth), 1e-6);
    for (const Keyframe& k : graph.keyframes()) EXPECT_EQ(k.fragment, 0);
    for (const int frame : {0, 295, 300, 400}) {
      EXPECT_EQ(result.deformation.at(frame, 0).matrix(), Eigen::Isometry3d::Identity().matrix())
          << "what is not in the later fragment stays";
      EXPECT_GT(result.deformation.at(frame, 1).translation().norm(), 1);
    }
    EXPECT_TRUE(result.deformation.joins());
    EXPECT_EQ(result.deformation.fragmentAfter(1), 0);
  }
}

TEST(PoseGraphFragments, OneWhoseCoordinatesAreRightAlreadyIsJoinedToo) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(Poses(truth.begin(), truth.begin() + 30));
  addTo(graph, Poses(truth.begin() + 30, truth.end()), 1);
  const GraphResult result = graph.joinFragment(loopOf(truth, 12, 40));
  ASSERT_TRUE(result.accepted) << result.reason;
  EXPECT_FALSE(result.deformation.isIdentity());
  for (const Keyframe& k : graph.keyframes()) EXPECT_EQ(k.fragment, 0);
}

TEST(PoseGraphFragments, ALoopInOneFragmentLeavesTheOther) {
  const Poses truth = corridor();
  PoseGraph graph = twoFragments(truth);
  const PoseGraph before = graph;
  PoseConstraint loop = loopOf(truth, 35, 45);
  loop.T_from_to = loop.T_from_to * motion(0.05, 0, 0, 0);
  graph.addLoop(loop);
  ASSERT_TRUE(graph.optimise().accepted);
  const auto moved = [&](std::size_t i) {
    return graph.keyframes()[i].T_map_camera.matrix() !=
           before.keyframes()[i].T_map_camera.matrix();
  };
  for (std::size_t i = 0; i <= 35; ++i) EXPECT_FALSE(moved(i)) << i;
  EXPECT_TRUE(moved(45));
}

TEST(PoseGraphFragments, ADoubtfulSecondJoinIsRefusedAndUndone) {
  const Poses truth = corridor();
  PoseGraph graph = twoFragments(truth);
  ASSERT_TRUE(graph.joinFragment(loopOf(truth, 12, 40)).accepted);
  const PoseGraph before = graph;
  PoseConstraint wrong = loopOf(truth, 14, 38);
  wrong.T_from_to = wrong.T_from_to * motion(0, 0, 1.0, 0);
  graph.addLoop(wrong);
  EXPECT_FALSE(graph.optimise().accepted);
  expectUnchanged(graph, before);
}

/// The corridor and, later, pieces of its way back each in coordinates of its own, reckoned from
/// keyframe 29.
PoseGraph reckonedPieces(const Poses& truth, const std::vector<int>& firsts) {
  PoseGraph graph = graphOf(Poses(truth.begin(), truth.begin() + 30));
  for (std::size_t i = 0; i < firsts.size(); ++i) {
    const auto at = static_cast<std::size_t>(firsts[i]);
    PoseConstraint reckoned = loopOf(truth, 29, firsts[i]);
    reckoned.covariance = independentCovariance(0.1, 0.05);
    const Eigen::Isometry3d away = motion(50, 3, -20, 1.2 * static_cast<double>(i));
    const int fragment = static_cast<int>(i) + 1;
    const int id = graph.addFragment(
        keyframeAt(away * truth[at], graph.keyframes().size(), fragment), reckoned);
    graph.addKeyframe(keyframeAt(away * truth[at + 1], graph.keyframes().size(), fragment), id,
                      kTracking);
  }
  return graph;
}

/// The loop between other keyframes of the graph.
PoseConstraint between(PoseConstraint loop, int from, int to) {
  loop.from = from;
  loop.to = to;
  return loop;
}

TEST(PoseGraphFragments, DeadReckoningRefusesTheOtherOfTwoAlikePlaces) {
  const Poses truth = corridor();
  PoseGraph graph = reckonedPieces(truth, {50});
  const PoseGraph before = graph;
  const GraphResult alike = graph.joinFragment(between(loopOf(truth, 9, 50), 20, 30));
  EXPECT_FALSE(alike.accepted);
  ASSERT_EQ(alike.refused.size(), 1U);
  EXPECT_NE(alike.reason.find("dead reckoning"), std::string::npos) << alike.reason;
  expectUnchanged(graph, before);
  ASSERT_EQ(graph.keptConstraints().size(), graph.constraints().size() + 1);
  ASSERT_TRUE(graph.joinFragment(between(loopOf(truth, 9, 50), 9, 30)).accepted);
  EXPECT_LT(distance(graph.keyframes()[30].T_map_camera, truth[50]), 1e-6);
  EXPECT_EQ(graph.keptConstraints().size(), graph.constraints().size()) << "its place is known";
}

TEST(PoseGraphFragments, TwoOfUnknownPlaceAreReckonedByWayOfWhatBothCameFrom) {
  const Poses truth = corridor();
  PoseGraph graph = reckonedPieces(truth, {35, 50});
  PoseConstraint wrong = between(loopOf(truth, 35, 50), 30, 32);
  wrong.T_from_to = motion(0, 0, 3, 0) * wrong.T_from_to;
  EXPECT_FALSE(graph.joinFragment(wrong).accepted);
  ASSERT_TRUE(graph.joinFragment(between(loopOf(truth, 35, 50), 30, 32)).accepted);
  for (int i = 30; i < 34; ++i) {
    EXPECT_EQ(graph.keyframes()[static_cast<std::size_t>(i)].fragment, 1);
  }
  EXPECT_EQ(graph.keptConstraints().size(), graph.constraints().size() + 2) << "of both";
}

TEST(PoseGraphFragments, ReckoningIsKeptAcrossFilesAndHandOvers) {
  const Poses truth = corridor();
  PoseGraph graph = reckonedPieces(truth, {50});
  PoseGraph copy = graph.handOver();
  graph.addFragment(keyframeAt(truth[40], 32, 2), between(loopOf(truth, 29, 40), 29, 32));
  graph.takeUp(std::move(copy), {});
  EXPECT_EQ(graph.keptConstraints().size(), graph.constraints().size() + 2);
  PoseGraph again(graph.config(), graph.keyframes(), graph.keptConstraints(), graph.version());
  EXPECT_EQ(again.constraints().size(), graph.constraints().size());
  EXPECT_FALSE(again.joinFragment(between(loopOf(truth, 9, 50), 20, 30)).accepted);
  EXPECT_TRUE(again.joinFragment(between(loopOf(truth, 9, 50), 9, 30)).accepted);
}

}  // namespace
}  // namespace pf

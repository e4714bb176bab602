// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace pf

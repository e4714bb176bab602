// SPDX-License-Identifier: BSD-3-Clause
// A graph that is corrected on a copy while keyframes are added to it.
#include "graph_scene.hpp"

namespace pf {
namespace {

constexpr int kKnown = 50;  // keyframes when the copy is made

/// The first keyframes of a corridor, tracked with a drift, and the loop that mends it.
PoseGraph begun() {
  const Poses tracked = drifted(corridor(), kYawDrift);
  return graphOf(Poses(tracked.begin(), tracked.begin() + kKnown));
}

const PoseConstraint kLoop = loopOf(corridor(), 10, 49);

/// Goes on as it was tracked from the keyframe `from`.
int addNext(PoseGraph& graph, int from) {
  const std::size_t at = graph.keyframes().size();
  const Keyframe& last = graph.keyframes()[static_cast<std::size_t>(from)];
  return graph.addKeyframe(
      keyframeAt(last.T_map_camera * motion(0.05, 0, 0.2, 0.01), at, last.fragment), from,
      kTracking);
}

Eigen::Isometry3d pose(const PoseGraph& graph, int i) {
  return graph.keyframes()[static_cast<std::size_t>(i)].T_map_camera;
}

TEST(PoseGraphHandOver, WhereNothingCameMeanwhileItIsTheSameAsAtOnce) {
  PoseGraph at_once = begun(), beside = at_once;
  const ClosedLoops closed = at_once.close({kLoop});
  PoseGraph copy = beside.handOver();
  const ClosedLoops also = copy.close({kLoop});
  const auto deformations = beside.takeUp(std::move(copy), also.deformations);
  expectUnchanged(beside, at_once);
  ASSERT_EQ(deformations.size(), closed.deformations.size());
  for (int frame = 0; frame < kKnown * kFramesApart; ++frame) {
    EXPECT_EQ(deformations[0].at(frame).matrix(), closed.deformations[0].at(frame).matrix());
  }
}

TEST(PoseGraphHandOver, WhatCameMeanwhileGoesWithWhatItWasTrackedFrom) {
  PoseGraph graph = begun();
  PoseGraph copy = graph.handOver();
  const int next = addNext(graph, kKnown - 1);
  const int second = addNext(graph, next);
  const int back = addNext(graph, 20);  // a return: tied to a keyframe of long ago
  const int after = addNext(graph, back);
  graph.addLoop(loopOf(corridor(), 5, 30));
  const PoseGraph before = graph;
  const ClosedLoops closed = copy.close({kLoop});
  ASSERT_EQ(closed.deformations.size(), 1U);
  const auto deformations = graph.takeUp(std::move(copy), closed.deformations);
  ASSERT_GT(distance(pose(graph, kKnown - 1), pose(before, kKnown - 1)), 0.05);
  const std::vector<std::pair<int, int>> steps = {
      {kKnown - 1, next}, {next, second}, {20, back}, {back, after}};
  for (const auto& [from, to] : steps) {
    const Eigen::Isometry3d was = pose(before, from).inverse() * pose(before, to);
    EXPECT_TRUE((pose(graph, from).inverse() * pose(graph, to)).isApprox(was, 1e-9)) << to;
  }
  for (int i = 0; i <= after; ++i) {  // surfels go with the keyframes that they hang on
    const auto frame = static_cast<std::int32_t>(i) * kFramesApart;
    EXPECT_TRUE((deformations[0].at(frame) * pose(before, i)).isApprox(pose(graph, i), 1e-9)) << i;
  }
  EXPECT_EQ(graph.constraints().size(), before.constraints().size() + 1);
  EXPECT_EQ(graph.version(), before.version() + 1);
  EXPECT_EQ(graph.close({}).accepted, 1U) << "the loop that came meanwhile waits for the next";
}

TEST(PoseGraphHandOver, LoopsThatWaitGoWithTheCopy) {
  PoseGraph graph = begun();
  graph.addLoop(kLoop);
  PoseGraph copy = graph.handOver();
  const ClosedLoops closed = copy.close({});
  EXPECT_EQ(closed.accepted, 1U);
  graph.takeUp(std::move(copy), closed.deformations);
  EXPECT_EQ(graph.close({}).accepted, 0U) << "not twice";
}

TEST(PoseGraphHandOver, AFragmentThatIsJoinedTakesWhatCameMeanwhileAlong) {
  const Poses truth = corridor();
  PoseGraph graph = twoFragments(truth);
  PoseGraph copy = graph.handOver();
  const int next = addNext(graph, 59);
  const int elsewhere = graph.addKeyframe(keyframeAt(motion(1, 2, 3, 0), 61, 2));
  const Eigen::Isometry3d step = pose(graph, 59).inverse() * pose(graph, next);
  const Eigen::Isometry3d T_elsewhere = pose(graph, elsewhere);
  const ClosedLoops closed = copy.close({loopOf(truth, 29, 30)});
  ASSERT_EQ(closed.joined, 1U);
  graph.takeUp(std::move(copy), closed.deformations);
  EXPECT_EQ(graph.keyframes()[static_cast<std::size_t>(next)].fragment, 0);
  EXPECT_TRUE((pose(graph, 59).inverse() * pose(graph, next)).isApprox(step, 1e-9));
  EXPECT_LT(distance(pose(graph, 59), truth[59]), 1e-3);
  EXPECT_EQ(graph.keyframes()[static_cast<std::size_t>(elsewhere)].fragment, 2);
  EXPECT_EQ(pose(graph, elsewhere).matrix(), T_elsewhere.matrix()) << "its place is not known";
}

}  // namespace
}  // namespace pf

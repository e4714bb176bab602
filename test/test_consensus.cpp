// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/consensus.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "graph_scene.hpp"

namespace pf {
namespace {

// Two pieces of one walk, the second in coordinates of its own.
constexpr int kFirst = 30, kAll = 60;

PoseGraph pieces(double drift = 0) {
  const Poses truth = corridor();
  PoseGraph graph =
      graphOf(drifted({truth.begin(), truth.begin() + kFirst}, motion(0, 0, drift, 0)));
  Poses later(truth.begin() + kFirst, truth.end());
  for (auto& T : later) T = motion(5, 3, -2, 1.2) * T;
  addTo(graph, later, 1);
  return graph;
}

Consensus of(const PoseGraph& graph, const std::vector<PoseConstraint>& loops) {
  return consensusOf(graph.config(), graph.keyframes(), graph.constraints(), loops);
}

/// Between the two pieces, as they are: each keyframe with the one at its place on the way back.
std::vector<PoseConstraint> rightOnes(int count) {
  std::vector<PoseConstraint> loops;
  const Poses truth = corridor();
  for (int i = 0; i < count; ++i) loops.push_back(loopOf(truth, 3 * i, kAll - 1 - 3 * i));
  return loops;
}

PoseConstraint wrong(PoseConstraint loop, const Eigen::Isometry3d& by) {
  loop.T_from_to = by * loop.T_from_to;
  return loop;
}

bool holds(const std::vector<PoseConstraint>& loops, const PoseConstraint& one) {
  return std::any_of(loops.begin(), loops.end(),
                     [&](const auto& loop) { return loop.from == one.from && loop.to == one.to; });
}

TEST(Consensus, OfNothingIsNothing) {
  const Consensus none = of(pieces(), {});
  EXPECT_TRUE(none.agreeing.empty());
  EXPECT_EQ(none.independent, 0U);
  EXPECT_EQ(none.against, 0U);
}

TEST(Consensus, RightLoopsAgree) {
  const Consensus all = of(pieces(), rightOnes(8));
  EXPECT_EQ(all.agreeing.size(), 8U);
  EXPECT_EQ(all.independent, 8U);
  EXPECT_EQ(all.against, 0U);
}

TEST(Consensus, WrongOnesAreLeftOutWhereverTheyStand) {
  const std::vector<PoseConstraint> right = rightOnes(6);
  for (std::size_t at = 0; at <= right.size(); ++at) {
    std::vector<PoseConstraint> loops = right;
    const PoseConstraint bad = wrong(loopOf(corridor(), 29, 33), motion(2, 0, 1, 0.7));
    loops.insert(loops.begin() + static_cast<std::ptrdiff_t>(at), bad);
    const Consensus found = of(pieces(), loops);
    EXPECT_EQ(found.agreeing.size(), right.size()) << at;
    EXPECT_FALSE(holds(found.agreeing, bad)) << at;
    EXPECT_EQ(found.against, 1U) << at;
  }
}

TEST(Consensus, WhatContradictsItselfIsCounted) {
  std::vector<PoseConstraint> loops = rightOnes(4);
  for (const PoseConstraint& loop : rightOnes(7)) {  // another place that looks the same
    if (loop.from >= 12) loops.push_back(wrong(loop, motion(1.5, 0, 3, 0.4)));
  }
  const Consensus found = of(pieces(), loops);
  EXPECT_EQ(found.independent, 4U);
  EXPECT_GE(found.against, 1U);
}

TEST(Consensus, ManyLoopsOfOnePlaceAreOne) {
  std::vector<PoseConstraint> loops;
  for (int i = 0; i < 5; ++i) loops.push_back(loopOf(corridor(), 10, 44 + i));
  const Consensus found = of(pieces(), loops);
  EXPECT_EQ(found.agreeing.size(), 5U);
  EXPECT_EQ(found.independent, 1U) << "all hang on the picture of one keyframe";
}

TEST(Consensus, DriftBetweenPlacesIsBorneAsFarAsTrackingMayHaveIt) {
  const std::vector<PoseConstraint> loops = rightOnes(8);
  EXPECT_EQ(of(pieces(0.01), loops).agreeing.size(), 8U);
  EXPECT_LT(of(pieces(0.2), loops).agreeing.size(), 8U);
}

TEST(Consensus, IsTheSameTheOtherWayRoundAndForOneThread) {
  std::vector<PoseConstraint> loops = rightOnes(6), turned;
  loops.push_back(wrong(loopOf(corridor(), 29, 33), motion(2, 0, 1, 0.7)));
  for (PoseConstraint loop : loops) {
    std::swap(loop.from, loop.to);
    loop.T_from_to = loop.T_from_to.inverse();
    turned.push_back(loop);
  }
  const Consensus found = of(pieces(), loops);
  EXPECT_EQ(of(pieces(), turned).agreeing.size(), found.agreeing.size());
  EXPECT_EQ(of(pieces(), turned).independent, found.independent);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  const Consensus again = of(pieces(), loops);
  ASSERT_EQ(again.agreeing.size(), found.agreeing.size());
  for (std::size_t i = 0; i < found.agreeing.size(); ++i) {
    EXPECT_EQ(again.agreeing[i].from, found.agreeing[i].from);
  }
}

}  // namespace
}  // namespace pf

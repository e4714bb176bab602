// SPDX-License-Identifier: BSD-3-Clause
// Wrong loops that hold are taken back when true ones contradict them.
#include <random>

#include "graph_scene.hpp"

namespace pf {
namespace {

/// Five loops between two stretches, all wrong by the same motion: consistent with each other.
std::vector<PoseConstraint> wrongLoops(const PoseGraph& graph, int from, int to,
                                       const Eigen::Isometry3d& off) {
  std::vector<PoseConstraint> loops;
  for (int k = 0; k < 5; ++k) {
    const auto pose = [&](int i) {
      return graph.keyframes()[static_cast<std::size_t>(i)].T_map_camera;
    };
    PoseConstraint loop;
    loop.from = from + k;
    loop.to = to + k;
    loop.T_from_to = pose(loop.from).inverse() * off * pose(loop.to);
    loop.covariance = 1e-5 * Matrix6d::Identity();
    loops.push_back(loop);
  }
  return loops;
}

bool has(const std::vector<PoseConstraint>& all, const PoseConstraint& loop) {
  return std::any_of(all.begin(), all.end(), [&](const PoseConstraint& c) {
    return c.from == loop.from && c.to == loop.to &&
           c.T_from_to.matrix() == loop.T_from_to.matrix();
  });
}

class Reconsider : public ::testing::TestWithParam<unsigned> {};

TEST_P(Reconsider, WrongLoopsThatHoldGoWhenMoreTrueOnesContradictThem) {
  const Poses truth = figureEight();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  std::mt19937 random(GetParam());
  std::uniform_real_distribution<double> length(0.3, 1.0), angle(0, 2 * M_PI);
  const double a = angle(random), r = length(random);
  const auto wrong = wrongLoops(graph, 3, 73, motion(r * std::cos(a), 0, r * std::sin(a), 0.1));
  for (const PoseConstraint& loop : wrong) graph.close({loop});
  ASSERT_TRUE(has(graph.constraints(), wrong[4])) << "nothing speaks against them yet";
  std::size_t withdrawn = 0;
  // The way crosses itself and comes home: true loops, one after the other.
  for (int k = 0; k < 10; ++k) withdrawn += graph.close({loopOf(truth, k, 71 + k)}).withdrawn;
  for (const PoseConstraint& loop : wrong) {
    EXPECT_FALSE(has(graph.constraints(), loop));
    EXPECT_TRUE(has(graph.doubted(), loop));
  }
  EXPECT_EQ(withdrawn, wrong.size());
  for (int k = 0; k < 10; ++k) EXPECT_TRUE(has(graph.constraints(), loopOf(truth, k, 71 + k))) << k;
  PoseGraph without = graphOf(drifted(truth, kYawDrift));
  for (int k = 0; k < 10; ++k) without.close({loopOf(truth, k, 71 + k)});
  EXPECT_LE(worstDistance(graph, truth), 1.1 * worstDistance(without, truth) + 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Directions, Reconsider, ::testing::Values(1U, 2U, 3U, 4U, 5U, 6U));

TEST(Reconsidered, SoftOdometryThatBendsBetweenBothIsNoReasonToAcceptBoth) {
  // Between the wrong stretch and the true one lie a few steps, which could take up all of it.
  const Poses truth = figureEight();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  const auto wrong = wrongLoops(graph, 5, 60, motion(0.9, 0, 0.4, 0.2));
  graph.close(wrong);
  ASSERT_TRUE(has(graph.constraints(), wrong[2]));
  for (int k = 0; k < 10; ++k) graph.close({loopOf(truth, k % 5, 66 + k)});
  for (const PoseConstraint& loop : wrong) EXPECT_FALSE(has(graph.constraints(), loop));
  EXPECT_TRUE(has(graph.constraints(), loopOf(truth, 0, 66)));
  EXPECT_LT(worstDistance(graph, truth), 0.3);
}

TEST(Reconsidered, TrueLoopsThatHoldStayDespiteAFewWrongOnes) {
  const Poses truth = figureEight();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  for (int k = 0; k < 10; ++k) graph.close({loopOf(truth, k, 71 + k)});
  const auto wrong = wrongLoops(graph, 5, 72, motion(0.4, 0, 0.3, 0.1));
  for (const PoseConstraint& loop : wrong) {
    const ClosedLoops closed = graph.close({loop});
    EXPECT_EQ(closed.refused, 1U);
    EXPECT_EQ(closed.withdrawn, 0U);
    EXPECT_FALSE(has(graph.constraints(), loop));
  }
  for (int k = 0; k < 10; ++k) EXPECT_TRUE(has(graph.constraints(), loopOf(truth, k, 71 + k)));
}

TEST(Reconsidered, AWrongReturnIsLetGoOnceLoopsTieWhatCameAfterIt) {
  // Found again 0.5 m beside where it is; all after it is tracked from there.
  const Poses truth = corridor();
  PoseGraph graph = graphOf(Poses(truth.begin(), truth.begin() + 30));
  const Eigen::Isometry3d off = motion(0.5, 0, 0, 0.1);
  const int back = graph.addKeyframe(keyframeAt(off * truth[40], 40), 19, kTracking);
  for (std::size_t i = 41; i < 55; ++i) {
    graph.addKeyframe(keyframeAt(off * truth[i], i), static_cast<int>(graph.keyframes().size()) - 1,
                      kTracking);
  }
  const auto loop = [&](int k) {  // the way back passes what was seen on the way there
    PoseConstraint c = loopOf(truth, 19 - k, 40 + k);
    c.to = back + k;
    return c;
  };
  for (int k = 0; k < 6; ++k) graph.close({loop(k)});
  for (int k = 0; k < 15; ++k) {
    EXPECT_LT(distance(graph.keyframes()[static_cast<std::size_t>(back + k)].T_map_camera,
                       truth[static_cast<std::size_t>(40 + k)]),
              0.02);
  }
}

TEST(Reconsidered, WhereNoneWasRefusedThereIsNothingToWeigh) {
  PoseGraph graph = graphOf(corridor());
  const PoseGraph before = graph;
  EXPECT_FALSE(graph.reconsider().accepted);
  expectUnchanged(graph, before);
}

TEST(Reconsidered, NoMoreAreKeptThanAreWorthTheTime) {
  const Poses truth = figureEight();
  PoseGraph graph = graphOf(drifted(truth, kYawDrift));
  for (int k = 0; k < 10; ++k) graph.close({loopOf(truth, k, 71 + k)});
  std::vector<PoseConstraint> wrong;
  for (int k = 0; k < 21; ++k) {
    for (const auto& loop : wrongLoops(graph, 5, 70, motion(0.2 * k + 0.5, 0.2, 0, 0.1))) {
      wrong.push_back(loop);
    }
  }
  graph.close(wrong);
  EXPECT_EQ(graph.doubted().size(), 100U);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/expected_place.hpp"

#include <gtest/gtest.h>

#include <random>

#include "graph_scene.hpp"
#include "posefusion/graph/drift.hpp"

namespace pf {
namespace {

PoseConstraint reckoned(int from, const Eigen::Isometry3d& step, double sigma_m = 0.1) {
  PoseConstraint c;
  c.from = from;
  c.T_from_to = step;
  c.covariance = independentCovariance(sigma_m, 0.05);
  c.kind = ConstraintKind::reckoned;
  return c;
}

Eigen::Isometry3d poseOf(const PoseGraph& graph, int keyframe) {
  return graph.keyframes()[static_cast<std::size_t>(keyframe)].T_map_camera;
}

TEST(Ways, TheShortestIsGone) {
  const Poses truth = corridor();
  PoseGraph graph = graphOf(truth);
  const auto steps = Ways(60, graph.constraints()).stepsFrom(59);
  for (int i = 0; i < 60; ++i) EXPECT_EQ(steps[static_cast<std::size_t>(i)], 59 - i);
  graph.addLoop(loopOf(truth, 2, 57));
  graph.optimise();
  EXPECT_EQ(Ways(60, graph.constraints()).stepsFrom(59)[0], 5);
  EXPECT_EQ(Ways(3, {}).stepsFrom(0)[2], 3) << "no way leads there";
}

TEST(DriftCovariance, GrowsWithStepsAndTurnsReachFar) {
  const GraphConfig config;
  EXPECT_TRUE(driftCovariance(config, 0, 5).isZero());
  const Matrix6d near = driftCovariance(config, 9, 0), far = driftCovariance(config, 9, 30);
  EXPECT_NEAR(std::sqrt(near(0, 0)), 3 * config.odometry_sigma_m, 1e-12);
  EXPECT_NEAR(std::sqrt(near(5, 5)), 3 * config.odometry_sigma_rad, 1e-12);
  EXPECT_GT(far(0, 0), 10 * near(0, 0));
  EXPECT_EQ(far(5, 5), near(5, 5));
}

TEST(ExpectedPlace, AdmitsWhereTheCameraCanBeAndNothingElse) {
  const PoseGraph graph = graphOf(corridor());
  const ExpectedPlace place(graph, reckoned(59, motion(0.3, 0, 0, 0)));
  const Eigen::Isometry3d T = poseOf(graph, 59) * motion(0.3, 0, 0, 0);
  EXPECT_NEAR(place.chiSquare({kFirstFragment, T}), 0, 1e-12);
  EXPECT_TRUE(place.admits({kFirstFragment, T * motion(0.3, 0, 0.1, 0.1)}));
  EXPECT_FALSE(place.admits({kFirstFragment, T * motion(1.5, 0, 0, 0)}));
  EXPECT_FALSE(place.admits({kFirstFragment, T * motion(0, 0, 0, 1.5)}));
  EXPECT_TRUE(place.admits({7, T * motion(50, 0, 0, 0)})) << "nothing is known of that fragment";
}

TEST(ExpectedPlace, AllowsForTheDriftOfTheMapInBetween) {
  // Back where the walk began, which the map has at 0.65 m beside.
  const PoseGraph graph = graphOf(corridor());
  const Eigen::Isometry3d beside = motion(0.65, 0, 0, 0);
  const ExpectedPlace late(graph, reckoned(59, beside, 0.02));
  EXPECT_TRUE(late.admits({kFirstFragment, poseOf(graph, 0) * motion(0, 0, 0, 3.0)}))
      << "60 steps ago";
  const ExpectedPlace soon(graph, reckoned(1, beside, 0.02));
  EXPECT_FALSE(soon.admits({kFirstFragment, poseOf(graph, 0)})) << "a step ago";
}

TEST(ExpectedPlace, APlaceIsLeftOutOnlyWhereNothingNearItIsAdmitted) {
  Poses truth = corridor();
  PoseGraph graph = graphOf(truth);
  graph.addLoop(loopOf(truth, 20, 57));  // ways of different lengths lie side by side
  const ExpectedPlace expected(graph, reckoned(40, motion(0.3, 0.1, 0.2, 0.4), 0.3));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> along(-1.0, 1.0);
  int left_out = 0, admitted = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Isometry3d around = poseOf(graph, 40) * motion(5 * along(random), along(random),
                                                                5 * along(random), along(random));
    const double reach_m = 0.2 + std::abs(along(random));
    const bool admits_near = expected.admitsNear({kFirstFragment, around}, reach_m);
    left_out += admits_near ? 0 : 1;
    for (int k = 0; k < 200; ++k) {
      Eigen::Isometry3d near = around * motion(0, 0, 0, 0.5 * along(random), 0.1 * along(random));
      const Eigen::Vector3d way(along(random), along(random), along(random));
      near.translation() += reach_m * way.normalized() * std::abs(along(random));
      if (!expected.admits({kFirstFragment, near})) continue;
      ++admitted;
      ASSERT_TRUE(admits_near) << i;
    }
  }
  EXPECT_GT(left_out, 50);
  EXPECT_GT(admitted, 50);
  EXPECT_TRUE(expected.admitsNear({7, motion(90, 0, 0, 0)}, 0.5)) << "nothing is known of it";
}

TEST(ExpectedPlace, IsTheSameFromAnywhereTheMapLies) {
  const Poses truth = corridor();
  Poses elsewhere = truth;
  const Eigen::Isometry3d there = motion(3, -1, 8, 2, 0.3);
  for (auto& T : elsewhere) T = there * T;
  const PoseGraph a = graphOf(truth), b = graphOf(elsewhere);
  const Eigen::Isometry3d step = motion(0.2, 0, 0.1, 0.2), off = motion(0.4, 0.2, 0, 0.1);
  EXPECT_NEAR(ExpectedPlace(a, reckoned(40, step)).chiSquare({0, poseOf(a, 40) * off}),
              ExpectedPlace(b, reckoned(40, step)).chiSquare({0, poseOf(b, 40) * off}), 1e-6);
}

}  // namespace
}  // namespace pf

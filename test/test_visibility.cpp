// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/visibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "posefusion/map/fusion.hpp"
#include "posefusion/map/render.hpp"
#include "surfel_cloud.hpp"

namespace pf {
namespace {

Eigen::Isometry3d randomPose(std::mt19937& random, double reach_m) {
  std::normal_distribution<double> axis;
  std::uniform_real_distribution<double> place(-reach_m, reach_m);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(axis(random), axis(random), axis(random), axis(random))
                   .normalized()
                   .toRotationMatrix();
  T.translation() << place(random), place(random), place(random);
  return T;
}

bool equal(const ModelView& a, const ModelView& b) {
  return cv::norm(a.depth_m, b.depth_m, cv::NORM_INF) == 0 &&
         cv::norm(a.normal_x, b.normal_x, cv::NORM_INF) == 0 &&
         cv::norm(a.intensity, b.intensity, cv::NORM_INF) == 0;
}

TEST(VisibleBlocks, HideNothingThatAPictureOfAllShows) {
  const SurfelArrays surfels = cloud(20000, 8);
  const SurfelMap blocks = mapOf(surfels), one = mapOf(surfels, kOneBlock);
  std::mt19937 random(8);
  std::size_t named = 0;
  for (int k = 0; k < 60; ++k) {
    const Eigen::Isometry3d T = randomPose(random, 5);
    ModelView a, b;
    SurfelRenderer().render(blocks, smallCamera(), T, RenderOptions{}, a);
    SurfelRenderer().render(one, smallCamera(), T, RenderOptions{}, b);
    EXPECT_TRUE(equal(a, b)) << k;
    named += visibleBlocks(blocks, smallCamera(), {0, T}, 0).size();
  }
  EXPECT_LT(named, 60 * blocks.blocks().size() / 4) << "most blocks are out of view";
}

TEST(VisibleBlocks, AreOfThePosesFragment) {
  SurfelMap map = mapOf(cloud(5000, 8)), both = map;
  both.add(cloud(5000, 8, 4), 1);
  std::mt19937 random(3);
  for (int k = 0; k < 10; ++k) {
    const Eigen::Isometry3d T = randomPose(random, 2);
    ModelView alone, beside;
    SurfelRenderer().render(map, smallCamera(), T, RenderOptions{}, alone);
    SurfelRenderer().render(both, smallCamera(), T, RenderOptions{}, beside);
    EXPECT_TRUE(equal(alone, beside)) << k;
    EXPECT_EQ(visibleBlocks(both, smallCamera(), {0, T}, 0),
              visibleBlocks(map, smallCamera(), {0, T}, 0));
    for (const std::uint32_t block : visibleBlocks(both, smallCamera(), {1, T}, 0)) {
      EXPECT_EQ(both.blocks()[block].fragment, 1);
    }
  }
}

TEST(VisibleBlocks, KeepWhatLiesWithinTheDepth) {
  const SurfelArrays surfels = cloud(20000, 8);
  const SurfelMap map = mapOf(surfels);
  std::mt19937 random(2);
  for (int k = 0; k < 20; ++k) {
    const Eigen::Isometry3d T = randomPose(random, 2);
    RenderOptions near;
    near.max_depth_m = 2.0;
    ModelView a, b;
    SurfelRenderer().render(map, smallCamera(), T, near, a);
    SurfelRenderer().render(map, smallCamera(), T, RenderOptions{}, b);
    // Where the whole map shows something near, the picture of the near blocks shows the same.
    const cv::Mat within = (b.depth_m > 0) & (b.depth_m < 1.8);
    EXPECT_EQ(cv::norm(a.depth_m, b.depth_m, cv::NORM_INF, within), 0) << k;
    EXPECT_LT(visibleBlocks(map, smallCamera(), {0, T}, 2.0).size(),
              visibleBlocks(map, smallCamera(), {0, T}, 0).size());
  }
}

TEST(VisibleBlocks, WhatIsOutOfViewCostsNothingAndStays) {
  SurfelMap map(MapConfig{});
  Fuser fuser;
  for (int i = 0; i < 12; ++i) fuser.fuse(noisyFrame(0), Eigen::Isometry3d::Identity(), map);
  const auto before = rowsOf(map.collect());
  Eigen::Isometry3d away = Eigen::Isometry3d::Identity();
  away.translation().x() = 50;
  for (int i = 0; i < 70; ++i) fuser.fuse(noisyFrame(0), away, map);
  SurfelMap rest = map;
  rest.removeIf([](const SurfelArrays& s, std::size_t i) { return s.x[i] > 20; });
  SurfelMap stable = rest;
  stable.removeIf([&](const SurfelArrays& s, std::size_t i) { return !stable.isStable(s, i); });
  EXPECT_EQ(rest.size(), stable.size()) << "unstable surfels age out of view too";
  const auto after = rowsOf(stable.collect());
  EXPECT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end()));
}

}  // namespace
}  // namespace pf

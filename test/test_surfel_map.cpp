// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/surfel_map.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>
#include <opencv2/core.hpp>
#include <random>
#include <set>
#include <tuple>

#include "posefusion/map/fusion.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/map/visibility.hpp"
#include "small_camera.hpp"

namespace pf {
namespace {

/// So large that a map is hardly divided.
constexpr float kOneBlock = 1e4F;

/// Stable discs all over a cube of `side_m`, with random normals.
SurfelArrays cloud(std::size_t count, float side_m, int seed = 3) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<float> place(-0.5F * side_m, 0.5F * side_m);
  std::normal_distribution<float> axis;
  SurfelArrays s;
  s.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    s.x[i] = place(random);
    s.y[i] = place(random);
    s.z[i] = place(random);
    const Eigen::Vector3f n =
        Eigen::Vector3f(axis(random), axis(random), axis(random)).normalized();
    s.nx[i] = n.x();
    s.ny[i] = n.y();
    s.nz[i] = n.z();
    s.r[i] = s.g[i] = s.b[i] = static_cast<float>(i % 256);
    s.radius[i] = 0.01F + 0.02F * static_cast<float>(i % 7);
    s.weight[i] = s.confidence[i] = 50;
  }
  return s;
}

SurfelMap mapOf(const SurfelArrays& surfels, float block_side_m = SurfelMap::kBlockSide_m) {
  SurfelMap map(MapConfig{}, block_side_m);
  map.advance();
  map.add(surfels);
  return map;
}

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

/// A wall with a board before it that comes and goes, noisy, from a camera that moves.
WorkingFrame noisyFrame(int i) {
  RgbdFrame frame;
  frame.camera = smallCamera();
  frame.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(90 + i, 90, 90));
  frame.depth = cv::Mat(120, 160, CV_32FC1, cv::Scalar(2.0));
  if (i % 9 < 6) frame.depth(cv::Rect(60, 40, 40, 40)).setTo(1.3);
  cv::Mat noise(frame.depth.size(), CV_32FC1);
  cv::RNG generator(static_cast<std::uint64_t>(i) + 5);
  generator.fill(noise, cv::RNG::NORMAL, 0.0, 0.004);
  frame.depth += noise;
  WorkingFrame working;
  FrameConfig config;
  config.shrink = 1;
  working.assign(frame, cv::Mat(), config);
  return working;
}

Eigen::Isometry3d poseOf(int i) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.02 * i, 0.01 * i, 0;
  T.linear() = Eigen::AngleAxisd(0.02 * i, Eigen::Vector3d::UnitY()).toRotationMatrix();
  return T;
}

SurfelMap fused(float block_side_m, int frames) {
  SurfelMap map(MapConfig{}, block_side_m);
  Fuser fuser;
  for (int i = 0; i < frames; ++i) fuser.fuse(noisyFrame(i), poseOf(i), map);
  return map;
}

using Row = std::tuple<float, float, float, float, float, float, float, int, int>;

/// The surfels without their order.
std::multiset<Row> rowsOf(const SurfelArrays& s) {
  std::multiset<Row> rows;
  for (std::size_t i = 0; i < s.size(); ++i) {
    rows.emplace(s.x[i], s.y[i], s.z[i], s.nx[i], s.r[i], s.weight[i], s.confidence[i], s.seen[i],
                 s.violations[i]);
  }
  return rows;
}

bool equal(const ModelView& a, const ModelView& b) {
  return cv::norm(a.depth_m, b.depth_m, cv::NORM_INF) == 0 &&
         cv::norm(a.normal_x, b.normal_x, cv::NORM_INF) == 0 &&
         cv::norm(a.intensity, b.intensity, cv::NORM_INF) == 0;
}

TEST(SurfelMap, HoldsEachSurfelOnceWithinTheBoundsOfItsBlock) {
  const SurfelArrays surfels = cloud(5000, 6);
  const SurfelMap map = mapOf(surfels);
  EXPECT_EQ(map.size(), 5000U);
  EXPECT_EQ(map.stableCount(), 5000U);
  EXPECT_GT(map.blocks().size(), 1000U);
  EXPECT_EQ(rowsOf(map.collect()), rowsOf(surfels));
  for (const SurfelBlock& block : map.blocks()) {
    const SurfelArrays& s = block.surfels;
    for (std::size_t i = 0; i < s.size(); ++i) {
      EXPECT_TRUE(block.bounds.contains(Eigen::Vector3f(s.x[i], s.y[i], s.z[i])));
      EXPECT_LE(s.radius[i], block.largest_radius);
    }
    EXPECT_LE(block.bounds.diagonal().maxCoeff(), SurfelMap::kBlockSide_m * 1.001F);
  }
}

TEST(SurfelMap, BoundsFollowSurfelsThatFusionMoves) {
  const SurfelMap map = fused(SurfelMap::kBlockSide_m, 12);
  for (const SurfelBlock& block : map.blocks()) {
    const SurfelArrays& s = block.surfels;
    for (std::size_t i = 0; i < s.size(); ++i) {
      ASSERT_TRUE(block.bounds.contains(Eigen::Vector3f(s.x[i], s.y[i], s.z[i])));
      ASSERT_LE(s.radius[i], block.largest_radius);
    }
  }
}

TEST(SurfelMap, FusingWithBlocksIsFusingWithout) {
  const SurfelMap blocks = fused(SurfelMap::kBlockSide_m, 20), one = fused(kOneBlock, 20);
  EXPECT_GT(blocks.blocks().size(), 20U);
  EXPECT_LE(one.blocks().size(), 8U) << "one on each side of the axes";
  // The dead are swept up block by block, at different times.
  const auto alive = [](SurfelMap map) {
    map.removeIf([&](const SurfelArrays& s, std::size_t i) { return map.isDead(s, i); });
    return rowsOf(map.collect());
  };
  EXPECT_GT(alive(one).size(), 10000U);
  EXPECT_EQ(alive(blocks), alive(one));
}

TEST(SurfelMap, FusionGivesTheSameBitsForAnyNumberOfThreads) {
  SurfelArrays maps[2];
  for (int k = 0; k < 2; ++k) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, k == 0 ? 1 : 2);
    maps[k] = fused(SurfelMap::kBlockSide_m, 15).collect();
  }
  maps[0].forEachArray(maps[1], [](const auto& a, const auto& b) { EXPECT_TRUE(a == b); });
}

TEST(SurfelMap, RemovingKeepsTheOrderOfTheOthers) {
  SurfelArrays five;
  five.resize(5);
  for (int i = 0; i < 5; ++i) five.seen[i] = i;
  SurfelMap map = mapOf(five);
  EXPECT_EQ(map.removeIf([](const SurfelArrays& s, std::size_t i) { return s.seen[i] % 3 == 0; }),
            2U);
  EXPECT_EQ(map.collect().seen, (std::vector<std::int32_t>{1, 2, 4}));
  EXPECT_EQ(map.collect().violations.size(), 3U);
}

TEST(SurfelMap, MemoryIsCountedGivenBackAndNeverAboveTheLimit) {
  MapConfig config;
  config.memory_limit_mb = 2;
  SurfelMap map(config);
  const std::size_t limit = 2 * 1024 * 1024;
  for (int seed = 0; seed < 40; ++seed) {
    map.add(cloud(3000, 1.0F + 0.05F * static_cast<float>(seed), seed));
    std::size_t held = 0;
    for (const SurfelBlock& block : map.blocks()) {
      held += sizeof block;
      held += block.surfels.x.capacity() * 4 + block.surfels.seen.capacity() * 4 +
              (SurfelArrays::bytesPerSurfel() - 8) * block.surfels.violations.capacity();
    }
    EXPECT_EQ(map.memory(), held);
    ASSERT_LE(held, limit);
  }
  EXPECT_GT(map.memory(), limit * 9 / 10);
  EXPECT_EQ(map.size() + map.refused(), 40U * 3000U);
  map.removeIf([](const SurfelArrays&, std::size_t i) { return i % 10 != 0; });
  EXPECT_LT(map.memory(), limit / 2);
  EXPECT_GT(map.add(cloud(3000, 1)), 2000U) << "there is room again";
  map.clear();
  EXPECT_EQ(map.memory(), 0U);
  EXPECT_EQ(map.size(), 0U);
}

TEST(SurfelMap, PlacesThatAreNoPlacesAreLeftOut) {
  SurfelArrays s = cloud(4, 1);
  s.x[1] = std::numeric_limits<float>::quiet_NaN();
  s.y[2] = std::numeric_limits<float>::infinity();
  s.z[3] = 1e30F;
  SurfelMap map = mapOf(s);
  EXPECT_EQ(map.size(), 2U);
  EXPECT_EQ(map.refused(), 0U);
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
    named += visibleBlocks(blocks, smallCamera(), T, 0).size();
  }
  EXPECT_LT(named, 60 * blocks.blocks().size() / 4) << "most blocks are out of view";
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
    EXPECT_LT(visibleBlocks(map, smallCamera(), T, 2.0).size(),
              visibleBlocks(map, smallCamera(), T, 0).size());
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

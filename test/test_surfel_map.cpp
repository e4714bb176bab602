// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/surfel_map.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <limits>

#include "posefusion/map/fusion.hpp"
#include "surfel_cloud.hpp"

namespace pf {
namespace {

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

/// Moves all surfels of some blocks by a metre.
void moveByAMetre(SurfelMap& map, const std::vector<std::uint32_t>& blocks) {
  map.move({[](const SurfelBlock&) { return true; },
            [](SurfelArrays& s, int) {
              for (float& x : s.x) x += 1.0F;
            }},
           blocks);
}

TEST(SurfelMap, ACorrectedCopyIsTakenUpButForWhatChangedMeanwhile) {
  SurfelMap map = mapOf(cloud(2000, 3));
  map.advance();
  map.advance();
  map.add(cloud(50, 0.2F, 4));  // in view: changed last
  const SurfelMap first = map;
  SurfelMap corrected = map.resting(1);
  const SurfelMap before = corrected;
  EXPECT_LT(corrected.size(), map.size()) << "without what a frame would change next";
  moveByAMetre(corrected, allBlocks(corrected));
  map.advance();
  map.add(cloud(300, 6, 5));  // meanwhile
  const std::size_t size = map.size();
  const std::vector<std::uint32_t> rest = map.takeUp(before, corrected);
  EXPECT_GT(rest.size(), 0U);
  EXPECT_LT(rest.size(), map.blocks().size());
  moveByAMetre(map, rest);
  EXPECT_EQ(map.size(), size);
  for (std::size_t i = 0; i < first.blocks().size(); ++i) {
    const SurfelArrays &old = first.blocks()[i].surfels, &now = map.blocks()[i].surfels;
    ASSERT_GE(now.size(), old.size());
    for (std::size_t k = 0; k < old.size(); ++k) EXPECT_EQ(now.x[k], old.x[k] + 1.0F);
    EXPECT_TRUE(old.size() == 0 || map.blocks()[i].changed == map.frame()) << "it is to be saved";
  }
  std::size_t held = 0;
  for (const SurfelBlock& block : map.blocks()) {
    held += sizeof(SurfelBlock) + block.surfels.x.capacity() * SurfelArrays::bytesPerSurfel();
  }
  EXPECT_EQ(map.memory(), held);
}

TEST(SurfelMap, FragmentsShareNoBlockAndAreRestored) {
  SurfelMap map = mapOf(cloud(2000, 3));
  map.add(cloud(1000, 3, 4), 2);
  map.add(cloud(500, 5, 5));
  EXPECT_EQ(map.size(), 3500U);
  std::size_t count = 0;
  map.forEachSurfelOf(2, [&](const SurfelArrays&, std::size_t) { ++count; });
  EXPECT_EQ(count, 1000U);
  SurfelMap again(MapConfig{});
  again.restore(map.parts(), 7);
  ASSERT_EQ(again.blocks().size(), map.blocks().size());
  for (std::size_t i = 0; i < map.blocks().size(); ++i) {
    EXPECT_EQ(again.blocks()[i].fragment, map.blocks()[i].fragment);
    EXPECT_EQ(again.blocks()[i].surfels.x, map.blocks()[i].surfels.x);
  }
  map.removeFragments([](int fragment) { return fragment == 0; });
  EXPECT_EQ(rowsOf(map.collect()), rowsOf(cloud(1000, 3, 4)));
}

TEST(SurfelMap, BlocksAreSmallHoweverFarFromTheOrigin) {
  for (const Eigen::Vector3f& way :
       {Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(-1, 0, 0), Eigen::Vector3f(0, 1, 0),
        Eigen::Vector3f(0, -1, 0), Eigen::Vector3f(0, 0, -1), Eigen::Vector3f(0, 0, 1)}) {
    SurfelMap map(MapConfig{});
    std::size_t added = 0;
    for (const float far_m : {0.0F, 100.0F, 249.9F, 250.1F, 300.0F, 700.0F, 3000.0F, 400000.0F}) {
      SurfelArrays surfels = cloud(200, 2);
      for (std::size_t i = 0; i < surfels.size(); ++i) {
        surfels.x[i] += far_m * way.x();
        surfels.y[i] += far_m * way.y();
        surfels.z[i] += far_m * way.z();
      }
      added += map.add(surfels);
    }
    EXPECT_EQ(added, 1600U);
    EXPECT_GT(map.blocks().size(), 300U);
    for (const SurfelBlock& block : map.blocks()) {
      EXPECT_EQ(block.fragment, kFirstFragment);
      EXPECT_LE(block.bounds.sizes().maxCoeff(), SurfelMap::kBlockSide_m * 1.001F);
    }
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
  EXPECT_EQ(map.collect().odds.size(), 3U);
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
              (SurfelArrays::bytesPerSurfel() - 8) * block.surfels.odds.capacity();
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

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/fusion.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "fusion_scene.hpp"

namespace pf {
namespace {

/// Bytes that the arrays of a map have reserved.
std::size_t heldBy(const SurfelMap& map) {
  std::size_t bytes = 0;
  for (const SurfelBlock& block : map.blocks()) {
    bytes += sizeof block + block.surfels.x.capacity() * SurfelArrays::bytesPerSurfel();
  }
  return bytes;
}

TEST(Fuser, FirstFrameBecomesOneSurfelAPixel) {
  SurfelMap map{MapConfig{}};
  const FusionCounts counts = Fuser().fuse(scene(2.0), kIdentity, map);
  EXPECT_EQ(counts.inserted, 158U * 118U) << "all but the border, which has no normals";
  EXPECT_EQ(map.size(), counts.inserted);
  const SurfelArrays surfels = map.collect();
  EXPECT_NEAR(surfels.z[5000], 2.0, 1e-5);
  EXPECT_NEAR(surfels.nz[5000], -1.0, 1e-4);
  EXPECT_EQ(surfels.r[5000], 90);
}

TEST(Fuser, TheSameViewAgainAddsSupportAndNoSurfels) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  fuser.fuse(scene(2.0), kIdentity, map);
  const std::size_t size = map.size();
  for (int i = 0; i < 9; ++i) EXPECT_EQ(fuser.fuse(scene(2.0), kIdentity, map).inserted, 0U);
  EXPECT_EQ(map.size(), size);
  EXPECT_NEAR(map.collect().odds[100], 10 * static_odds::kFrame, 1e-5);
  EXPECT_EQ(map.stableCount(), size);
}

TEST(Fuser, WhatComesBeforeAKnownWallIsStableOnlyLater) {
  SurfelMap map{MapConfig{}};
  fuseOften(10, scene(3.0), map);
  fuseOften(30, scene(3.0, 1.5), map);
  EXPECT_GT(countNear(map, 1.5), 1000U) << "it is in the map";
  EXPECT_EQ(stableNear(map, 1.5), 0U) << "but may be a person";
  fuseOften(12, scene(3.0, 1.5), map);
  EXPECT_GT(stableNear(map, 1.5), 1000U) << "what stays is furniture";
}

TEST(Fuser, AHoleInTheKnownWallMakesNoPartOfWhatComesStableSooner) {
  SurfelMap map{MapConfig{}};
  WorkingFrame wall = scene(3.0);
  wall.depth_m(cv::Rect(74, 0, 12, 120)).setTo(0);
  fuseOften(10, wall, map);
  fuseOften(30, scene(3.0, 1.5), map);
  EXPECT_GT(countNear(map, 1.5), 1000U);
  EXPECT_EQ(stableNear(map, 1.5), 0U);
}

TEST(Fuser, WhatStandsBesideAThingThatCameIsStableSoon) {
  SurfelMap map{MapConfig{}};
  WorkingFrame wall = scene(3.0);
  wall.depth_m(cv::Rect(80, 0, 80, 120)).setTo(0);
  fuseOften(10, wall, map);
  WorkingFrame both = scene(3.0);
  both.depth_m(cv::Rect(40, 40, 40, 40)).setTo(1.5);  // came
  both.depth_m(cv::Rect(80, 40, 40, 40)).setTo(2.5);  // what is behind it was never seen
  fuseOften(10, both, map);
  EXPECT_EQ(stableNear(map, 1.5), 0U);
  EXPECT_GT(stableNear(map, 2.5), 1000U);
}

TEST(Fuser, WhatIsSeenTogetherWithItsWallIsStableSoon) {
  SurfelMap map{MapConfig{}};
  fuseOften(10, scene(3.0, 1.5), map);
  EXPECT_GT(stableNear(map, 1.5), 1000U);
}

TEST(Fuser, WhatStandsCloseBeforeAKnownWallIsStableSoon) {
  SurfelMap map{MapConfig{}};
  fuseOften(10, scene(3.0), map);
  fuseOften(10, scene(3.0, 2.8), map);
  EXPECT_GT(stableNear(map, 2.8), 1000U) << "a picture, a shelf";
}

TEST(Fuser, AveragesNoiseAway) {
  MapConfig config;
  config.max_weight = 1000;
  SurfelMap map(config);
  Fuser fuser;
  const double sigma = 0.004;
  for (int i = 0; i < 40; ++i) fuser.fuse(scene(1.5, 0, sigma, i), kIdentity, map);
  double sum = 0, squares = 0, count = 0;
  map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    if (!map.isStable(s, i)) return;
    sum += s.z[i] - 1.5;
    squares += std::pow(s.z[i] - 1.5, 2);
    count += 1;
  });
  EXPECT_NEAR(sum / count, 0, 0.1 * sigma) << "no bias";
  EXPECT_LT(std::sqrt(squares / count), 0.35 * sigma);
}

TEST(Fuser, ColoursComeAtTheExposureOfTheMap) {
  SurfelMap map{MapConfig{}};
  FusionOptions options;
  options.gain = 1.5F;
  options.offset = 10.0F;
  fuseOften(3, scene(2.0), map, options);
  EXPECT_NEAR(map.collect().r[5000], 145, 1e-3);
  options.gain = 10.0F;
  fuseOften(20, scene(2.0), map, options);
  EXPECT_LE(map.collect().r[5000], 255.0F);
}

TEST(Fuser, UnconfirmedSurfelsAreForgotten) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  fuser.fuse(scene(2.0), kIdentity, map);
  Eigen::Isometry3d away = kIdentity;
  away.translation().x() = 100;
  for (int i = 0; i < 65; ++i) fuser.fuse(scene(2.0), away, map);
  const auto x = map.collect().x;
  EXPECT_EQ(std::count_if(x.begin(), x.end(), [](float value) { return value < 50; }), 0);
}

TEST(Fuser, AFullMapTakesNoMoreAndReportsIt) {
  MapConfig config;
  config.memory_limit_mb = 1;
  SurfelMap map(config);
  Fuser().fuse(scene(2.0), kIdentity, map);
  EXPECT_EQ(map.refused(), 158U * 118U - map.size());
  EXPECT_LE(heldBy(map), 1024U * 1024U);
  EXPECT_GT(map.size() * SurfelArrays::bytesPerSurfel(), 768U * 1024U) << "little is wasted";
}

TEST(Fuser, GivesTheSameBitsForAnyNumberOfThreads) {
  SurfelMap maps[2] = {SurfelMap{MapConfig{}}, SurfelMap{MapConfig{}}};
  for (int k = 0; k < 2; ++k) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, k == 0 ? 1 : 4);
    Fuser fuser;
    for (int i = 0; i < 12; ++i) {
      Eigen::Isometry3d T = kIdentity;
      T.translation() << 0.01 * i, 0.005 * i, 0;
      fuser.fuse(scene(2.0, i % 3 == 0 ? 1.4 : 0, 0.004, i), T, maps[k]);
    }
  }
  const SurfelArrays a = maps[0].collect(), b = maps[1].collect();
  EXPECT_EQ(a.z, b.z);
  EXPECT_EQ(a.nx, b.nx);
  EXPECT_EQ(a.odds, b.odds);
}

}  // namespace
}  // namespace pf

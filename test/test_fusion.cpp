// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/fusion.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "small_camera.hpp"

namespace pf {
namespace {

FrameConfig fullResolution() {
  FrameConfig config;
  config.shrink = 1;
  return config;
}

/// A wall at `wall_m`, and a board of `grey` before its middle where `board_m` > 0.
WorkingFrame scene(double wall_m, double board_m = 0, double noise_m = 0, int seed = 0) {
  RgbdFrame frame;
  frame.camera = smallCamera();
  frame.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(90, 90, 90));
  frame.depth = cv::Mat(120, 160, CV_32FC1, cv::Scalar(wall_m));
  const cv::Rect board(60, 40, 40, 40);
  if (board_m > 0) {
    frame.depth(board).setTo(board_m);
    frame.color(board).setTo(cv::Scalar(200, 0, 0));
  }
  if (noise_m > 0) {
    cv::Mat noise(frame.depth.size(), CV_32FC1);
    cv::RNG random(static_cast<std::uint64_t>(seed) + 17);
    random.fill(noise, cv::RNG::NORMAL, 0.0, noise_m);
    frame.depth += noise;
  }
  WorkingFrame working;
  working.assign(frame, cv::Mat(), fullResolution());
  return working;
}

const Eigen::Isometry3d kIdentity = Eigen::Isometry3d::Identity();

std::size_t countNear(const SurfelMap& map, double z, double tolerance = 0.05) {
  const auto& all = map.surfels().z;
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](float value) { return std::abs(value - z) < tolerance; }));
}

TEST(Fuser, FirstFrameBecomesOneSurfelAPixel) {
  SurfelMap map{MapConfig{}};
  const FusionCounts counts = Fuser().fuse(scene(2.0), kIdentity, map);
  EXPECT_EQ(counts.inserted, 158U * 118U) << "all but the border, which has no normals";
  EXPECT_EQ(map.surfels().size(), counts.inserted);
  EXPECT_NEAR(map.surfels().z[5000], 2.0, 1e-5);
  EXPECT_NEAR(map.surfels().nz[5000], -1.0, 1e-4);
  EXPECT_EQ(map.surfels().r[5000], 90);
}

TEST(Fuser, TheSameViewAgainAddsSupportAndNoSurfels) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  fuser.fuse(scene(2.0), kIdentity, map);
  const std::size_t size = map.surfels().size();
  for (int i = 0; i < 9; ++i) EXPECT_EQ(fuser.fuse(scene(2.0), kIdentity, map).inserted, 0U);
  EXPECT_EQ(map.surfels().size(), size);
  EXPECT_EQ(map.surfels().confidence[100], 10);
  EXPECT_EQ(map.stableCount(), size);
}

TEST(Fuser, AveragesNoiseAway) {
  MapConfig config;
  config.max_weight = 1000;
  SurfelMap map(config);
  Fuser fuser;
  const double sigma = 0.004;
  for (int i = 0; i < 40; ++i) fuser.fuse(scene(1.5, 0, sigma, i), kIdentity, map);
  double sum = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < map.surfels().size(); ++i) {
    if (!map.isStable(i)) continue;
    sum += map.surfels().z[i] - 1.5;
    squares += std::pow(map.surfels().z[i] - 1.5, 2);
    count += 1;
  }
  EXPECT_NEAR(sum / count, 0, 0.1 * sigma) << "no bias";
  EXPECT_LT(std::sqrt(squares / count), 0.35 * sigma);
}

TEST(Fuser, WhatWentAwayIsRemovedOnceTheRoomBehindIsSeen) {
  // Somebody stands before the wall, unmasked, long enough to become stable.
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  for (int i = 0; i < 15; ++i) fuser.fuse(scene(3.0, 1.5), kIdentity, map);
  ASSERT_GT(countNear(map, 1.5), 1000U);
  int frames = 0;
  while (countNear(map, 1.5) > 0 && frames < 60) {
    fuser.fuse(scene(3.0), kIdentity, map);
    ++frames;
  }
  EXPECT_LE(frames, 20) << "gone within two thirds of a second";
  EXPECT_GT(countNear(map, 3.0), 17000U) << "and the wall is complete";
}

TEST(Fuser, WhatIsHiddenBehindSomebodyStays) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  for (int i = 0; i < 15; ++i) fuser.fuse(scene(3.0), kIdentity, map);
  const std::size_t wall = countNear(map, 3.0);
  for (int i = 0; i < 60; ++i) fuser.fuse(scene(3.0, 1.5), kIdentity, map);
  EXPECT_EQ(countNear(map, 3.0), wall);
}

TEST(Fuser, MissingDepthIsNoEvidence) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  for (int i = 0; i < 15; ++i) fuser.fuse(scene(2.0), kIdentity, map);
  const std::size_t size = map.surfels().size();
  WorkingFrame nothing = scene(2.0);
  nothing.depth_m.setTo(0);
  for (int i = 0; i < 60; ++i) fuser.fuse(nothing, kIdentity, map);
  EXPECT_EQ(map.surfels().size(), size);
}

TEST(Fuser, UnconfirmedSurfelsAreForgotten) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  fuser.fuse(scene(2.0), kIdentity, map);
  Eigen::Isometry3d away = kIdentity;
  away.translation().x() = 100;
  for (int i = 0; i < 45; ++i) fuser.fuse(scene(2.0), away, map);
  EXPECT_EQ(
      std::count_if(map.surfels().x.begin(), map.surfels().x.end(), [](float x) { return x < 50; }),
      0);
}

TEST(Fuser, AFullMapTakesNoMoreAndSaysSo) {
  MapConfig config;
  config.memory_limit_mb = 1;
  SurfelMap map(config);
  Fuser().fuse(scene(2.0), kIdentity, map);
  EXPECT_EQ(map.surfels().size(), map.capacity());
  EXPECT_EQ(map.refused(), 158U * 118U - map.capacity());
  EXPECT_LE(map.surfels().size() * SurfelArrays::bytesPerSurfel(), 1024U * 1024U);
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
  EXPECT_EQ(maps[0].surfels().z, maps[1].surfels().z);
  EXPECT_EQ(maps[0].surfels().nx, maps[1].surfels().nx);
  EXPECT_EQ(maps[0].surfels().confidence, maps[1].surfels().confidence);
}

TEST(Compact, KeepsTheOrderOfTheOthers) {
  SurfelArrays surfels;
  surfels.forEachArray([](auto& array) { array.resize(5); });
  for (int i = 0; i < 5; ++i) {
    surfels.x[i] = static_cast<float>(i);
    surfels.seen[i] = i;
  }
  EXPECT_EQ(compact({1, 0, 0, 1, 0}, surfels), 2U);
  EXPECT_EQ(surfels.x, (std::vector<float>{1, 2, 4}));
  EXPECT_EQ(surfels.seen, (std::vector<std::int32_t>{1, 2, 4}));
  EXPECT_EQ(surfels.violations.size(), 3U);
}

}  // namespace
}  // namespace pf

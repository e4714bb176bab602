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
  const auto all = map.collect().z;
  return static_cast<std::size_t>(std::count_if(
      all.begin(), all.end(), [&](float value) { return std::abs(value - z) < tolerance; }));
}

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
  EXPECT_EQ(map.collect().confidence[100], 10);
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
  map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    if (!map.isStable(s, i)) return;
    sum += s.z[i] - 1.5;
    squares += std::pow(s.z[i] - 1.5, 2);
    count += 1;
  });
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
  const std::size_t size = map.size();
  WorkingFrame nothing = scene(2.0);
  nothing.depth_m.setTo(0);
  for (int i = 0; i < 60; ++i) fuser.fuse(nothing, kIdentity, map);
  EXPECT_EQ(map.size(), size);
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

TEST(Fuser, AFullMapTakesNoMoreAndSaysSo) {
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
  EXPECT_EQ(a.confidence, b.confidence);
}

}  // namespace
}  // namespace pf

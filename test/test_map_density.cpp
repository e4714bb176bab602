// SPDX-License-Identifier: BSD-3-Clause
// How many surfels a surface gets: as many as depth tells apart.
#include <gtest/gtest.h>

#include <cmath>

#include "fusion_scene.hpp"

namespace pf {
namespace {

/// A wall through (0, 0, z_m), turned around the vertical by an angle; to the left it comes nearer.
RgbdFrame wallOf(double z_m, double angle_rad = 0, double noise_sigmas = 0, int seed = 0) {
  RgbdFrame frame;
  frame.camera = vga();
  frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar(90, 90, 90));
  frame.depth = cv::Mat(480, 640, CV_32FC1);
  cv::RNG random(static_cast<std::uint64_t>(seed) + 5);
  const DepthSensor sensor;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const double ray_x = (u - frame.camera.cx) / frame.camera.fx;
      const double z = z_m / (1.0 - ray_x * std::tan(angle_rad));
      const double sigma = noise_sigmas * sensor.sigma(static_cast<float>(z));
      frame.depth.at<float>(v, u) =
          static_cast<float>(z + (sigma > 0 ? random.gaussian(sigma) : 0.0));
    }
  }
  return frame;
}

WorkingFrame working(const RgbdFrame& frame) {
  WorkingFrame made;
  made.assign(frame, cv::Mat(), FrameConfig{});
  return made;
}

/// How far apart the surfels of a wall at z_m are that fills the picture (m).
double spacingOf(const SurfelMap& map, double z_m) {
  const double area = 640 * 480 * (z_m / 525) * (z_m / 525);
  return std::sqrt(area / static_cast<double>(map.size()));
}

TEST(MapDensity, ANearSurfaceGetsASurfelForEachPixelOfTheCamera) {
  for (const double z_m : {0.6, 1.0, 2.0}) {
    SurfelMap map{MapConfig{}};
    Fuser().fuse(working(wallOf(z_m)), kIdentity, map);
    EXPECT_GT(map.size(), 0.98 * 640 * 480) << z_m;
    EXPECT_LE(map.size(), 640U * 480U) << z_m;
  }
}

TEST(MapDensity, FarSurfelsAreAboutAsFarApartAsTheirDepthIsKnown) {
  const DepthSensor sensor;
  for (const double z_m : {3.0, 3.5, 4.0, 4.5}) {
    SurfelMap map{MapConfig{}};
    Fuser().fuse(working(wallOf(z_m)), kIdentity, map);
    const double sigma = sensor.sigma(static_cast<float>(z_m));
    EXPECT_GT(spacingOf(map, z_m), 0.45 * sigma) << z_m;
    EXPECT_LT(spacingOf(map, z_m), 1.1 * sigma) << z_m;
  }
}

TEST(MapDensity, NoSurfaceIsMappedCoarserThanTrackingLooksAtIt) {
  for (const double z_m : {5.0, 6.0, 7.5}) {
    SurfelMap map{MapConfig{}};
    Fuser().fuse(working(wallOf(z_m)), kIdentity, map);
    EXPECT_NEAR(static_cast<double>(map.size()), 320.0 * 240.0, 0.03 * 320 * 240) << z_m;
  }
}

TEST(MapDensity, TheSameForACameraOfAnySize) {
  // 640x480 and 320x240 of the same view: where the smaller one resolves what depth can tell apart,
  // both make surfels of one size.
  for (const double z_m : {3.0, 6.0}) {
    RgbdFrame small = wallOf(z_m);
    small.camera = small.camera.shrunk(2);
    small.color = small.color(cv::Rect(0, 0, 320, 240)).clone();
    small.depth = small.depth(cv::Rect(0, 0, 320, 240)).clone();
    SurfelMap map{MapConfig{}}, of_small{MapConfig{}};
    Fuser().fuse(working(wallOf(z_m)), kIdentity, map);
    Fuser().fuse(working(small), kIdentity, of_small);
    EXPECT_NEAR(static_cast<double>(map.size()) / static_cast<double>(of_small.size()), 1.0, 0.05);
  }
}

TEST(MapDensity, ASettingMakesItCoarser) {
  MapConfig config;
  config.shrink = 2;
  SurfelMap map{config};
  Fuser().fuse(working(wallOf(1.0)), kIdentity, map);
  EXPECT_NEAR(static_cast<double>(map.size()), 320.0 * 240.0, 0.03 * 320 * 240);
}

TEST(MapDensity, AWallThroughAllLevelsIsCoveredOnce) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  const WorkingFrame frame = working(wallOf(2.4, 0.9));
  const std::size_t first = fuser.fuse(frame, kIdentity, map).inserted;
  for (int i = 0; i < 9; ++i) EXPECT_EQ(fuser.fuse(frame, kIdentity, map).inserted, 0U) << i;
  EXPECT_EQ(map.size(), first);
  EXPECT_EQ(map.stableCount(), first);
}

TEST(MapDensity, NoiseMakesFewSurfelsMore) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  fuser.fuse(working(wallOf(2.4, 0.9, 1.0)), kIdentity, map);
  const std::size_t first = map.size();
  for (int i = 1; i < 15; ++i) fuser.fuse(working(wallOf(2.4, 0.9, 1.0, i)), kIdentity, map);
  EXPECT_LT(static_cast<double>(map.size()), 1.25 * static_cast<double>(first));
}

TEST(MapDensity, AWallThatComesNearerIsMappedFinerInOneLayer) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  const auto fuseFrom = [&](double z_m) {
    Eigen::Isometry3d pose = kIdentity;
    pose.translation().z() = 5.0 - z_m;
    fuser.fuse(working(wallOf(z_m)), pose, map);
  };
  for (int i = 0; i <= 40; ++i) fuseFrom(5.0 - 0.1 * i);
  for (int i = 0; i < 15; ++i) fuseFrom(1.0);
  const double area = 640 * 480 / (525.0 * 525.0);  // m^2, seen from 1 m
  std::size_t near_middle = 0;
  map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    EXPECT_NEAR(s.z[i], 5.0, 0.01);
    near_middle += std::abs(s.x[i]) < 0.5 * 640 / 525 && std::abs(s.y[i]) < 0.5 * 480 / 525;
  });
  const double spacing = std::sqrt(area / static_cast<double>(near_middle));
  EXPECT_LT(spacing, 1.7 / 525) << "much finer than the 19 mm of 5 m away";
  EXPECT_GT(spacing, 0.7 / 525) << "but no second layer";
}

}  // namespace
}  // namespace pf

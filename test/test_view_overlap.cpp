// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/view_overlap.hpp"

#include <gtest/gtest.h>

#include "fusion_scene.hpp"

namespace pf {
namespace {

/// A map of a wall 2 m away, seen so often.
SurfelMap wallMap(int frames) {
  SurfelMap map{MapConfig{}};
  fuseOften(frames, scene(2.0), map);
  return map;
}

RgbdFrame wallAt(double depth_m) {
  RgbdFrame frame;
  frame.camera = smallCamera();
  frame.depth = cv::Mat(120, 160, CV_32FC1, cv::Scalar(depth_m));
  return frame;
}

TEST(ViewOverlap, IsTheShareThatTheMapHas) {
  const SurfelMap map = wallMap(12);
  ViewOverlap overlap(map);
  EXPECT_GT(overlap.of(wallAt(2.0), kIdentity), 0.97);
  EXPECT_GT(overlap.of(wallAt(2.04), kIdentity), 0.97) << "within the noise";
  EXPECT_LT(overlap.of(wallAt(2.3), kIdentity), 0.01) << "another wall";
  RgbdFrame half = wallAt(2.0);
  half.depth.colRange(0, 80).setTo(1.0);
  EXPECT_NEAR(overlap.of(half, kIdentity), 0.5, 0.03);
  half.depth.colRange(0, 80).setTo(0.0);
  EXPECT_GT(overlap.of(half, kIdentity), 0.95) << "of the pixels with depth";
  EXPECT_EQ(overlap.of(wallAt(0.0), kIdentity), 0.0);
}

TEST(ViewOverlap, IsOfThePoseGiven) {
  const SurfelMap map = wallMap(12);
  ViewOverlap overlap(map);
  Eigen::Isometry3d aside = kIdentity;
  aside.translation().x() = 2.0 * 80 / smallCamera().fx;  // half a picture
  EXPECT_NEAR(overlap.of(wallAt(2.0), aside), 0.5, 0.03);
}

TEST(ViewOverlap, WhatWasHardlySeenIsNotMapped) {
  const SurfelMap map = wallMap(3);
  EXPECT_EQ(ViewOverlap(map).of(wallAt(2.0), kIdentity), 0.0);
}

}  // namespace
}  // namespace pf

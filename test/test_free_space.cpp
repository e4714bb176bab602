// SPDX-License-Identifier: BSD-3-Clause
// What a frame says of space where it measures no surface: free up to what it sees, or not known.
#include <gtest/gtest.h>

#include "fusion_scene.hpp"

namespace pf {
namespace {

constexpr int kSoon = 10, kLater = 40;  // frames until stable: of a part of the room, of a newcomer

Eigen::Isometry3d turnedAway() {
  return Eigen::Isometry3d(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitY()));
}

/// A map of nothing, after a second in which a wall 3 m away was seen.
class SeenFree : public ::testing::Test {
 protected:
  SeenFree() {
    for (int i = 0; i < 30; ++i) fuser_.fuse(scene(3.0), kIdentity, map_);
    map_.removeIf([](const SurfelArrays&, std::size_t) { return true; });
  }

  /// A board comes, and nothing is known behind it. How much of it is stable.
  std::size_t stableOfBoard(int frames, const Eigen::Isometry3d& pose = kIdentity,
                            int fragment = kFirstFragment) {
    FusionOptions options;
    options.fragment = fragment;
    for (int i = 0; i < frames; ++i) fuser_.fuse(scene(0, 1.5), pose, map_, options);
    return map_.stableCount();
  }

  SurfelMap map_{MapConfig{}};
  Fuser fuser_;
};

constexpr std::size_t kMostOfBoard = 1000;  // surfels, of 38 x 38

TEST_F(SeenFree, WhatComesIntoItIsStableOnlyLater) {
  EXPECT_EQ(stableOfBoard(30), 0U);
  EXPECT_GT(map_.size(), kMostOfBoard) << "it is in the map";
  EXPECT_GT(stableOfBoard(kLater - 30), kMostOfBoard) << "what stays is furniture";
}

TEST_F(SeenFree, NothingIsKnownOfWhatWasNotInView) {
  EXPECT_GT(stableOfBoard(kSoon, turnedAway()), kMostOfBoard);
}

TEST_F(SeenFree, IsThatOfItsFragment) {
  EXPECT_GT(stableOfBoard(kSoon, kIdentity, 1), kMostOfBoard);
}

TEST_F(SeenFree, FollowsACorrection) {
  Eigen::Isometry3d T_new_old = kIdentity;
  T_new_old.translation().x() = 20;
  fuser_.follow(Deformation(1, {{0, T_new_old, false}}));
  EXPECT_GT(stableOfBoard(kSoon), kMostOfBoard) << "seen from 20 m beside";
  map_.removeIf([](const SurfelArrays&, std::size_t) { return true; });
  EXPECT_EQ(stableOfBoard(kSoon, T_new_old), 0U);
}

TEST_F(SeenFree, IsForgottenWithTheMap) {
  fuser_.forget();
  EXPECT_GT(stableOfBoard(kSoon), kMostOfBoard);
}

TEST_F(SeenFree, IsForgottenAfterAWhile) {
  for (int i = 0; i < 22 * 30; ++i) fuser_.fuse(scene(0), turnedAway(), map_);
  EXPECT_GT(stableOfBoard(kSoon), kMostOfBoard);
}

TEST(SeenFreeOnProbation, IsNotBelieved) {
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  FusionOptions options;
  options.may_remove_stable = false;
  for (int i = 0; i < 30; ++i) fuser.fuse(scene(3.0), kIdentity, map, options);
  map.removeIf([](const SurfelArrays&, std::size_t) { return true; });
  for (int i = 0; i < kSoon; ++i) fuser.fuse(scene(0, 1.5), kIdentity, map);
  EXPECT_GT(map.stableCount(), kMostOfBoard);
}

/// Of one colour, with depth nowhere, or in every `measured_row`-th row.
WorkingFrame gap(const cv::Scalar& color, int measured_row = 0) {
  RgbdFrame frame;
  frame.camera = smallCamera();
  frame.color = cv::Mat(120, 160, CV_8UC3, color);
  frame.depth = cv::Mat(120, 160, CV_32FC1, cv::Scalar(0));
  for (int v = 0; measured_row > 0 && v < 120; v += measured_row) frame.depth.row(v).setTo(1.0);
  WorkingFrame working;
  working.assign(frame, cv::Mat(), fullResolution());
  return working;
}

const cv::Scalar kRed(200, 0, 0), kGrey(120, 120, 120);  // the board, the wall out of range

TEST(Gap, OfAnotherColourRemovesWhatStoodThere) {
  SurfelMap map{MapConfig{}};
  fuseOften(20, scene(0, 1.5), map);
  ASSERT_GT(map.stableCount(), kMostOfBoard);
  fuseOften(75, gap(kGrey), map);
  EXPECT_EQ(map.stableCount(), 0U);
}

TEST(Gap, OfTheSameColourSaysNothing) {
  SurfelMap map{MapConfig{}};
  fuseOften(20, scene(0, 1.5), map);
  const auto odds = map.collect().odds;
  fuseOften(75, gap(kRed), map);
  EXPECT_EQ(map.collect().odds, odds) << "shiny, or in a shadow of the projector";
}

TEST(Gap, UnderAMaskSaysNothing) {
  SurfelMap map{MapConfig{}};
  fuseOften(20, scene(0, 1.5), map);
  const auto odds = map.collect().odds;
  FusionOptions options;
  options.mask = cv::Mat(120, 160, CV_8UC1, cv::Scalar(255));
  options.input_depth_m = cv::Mat(120, 160, CV_32FC1, cv::Scalar(0));
  fuseOften(75, gap(kGrey), map, options);
  EXPECT_EQ(map.collect().odds, odds) << "a person hides it";
}

TEST(Gap, OfSomeSecondsLeavesWhatWasSeenLong) {
  SurfelMap map{MapConfig{}};
  fuseOften(60, scene(0, 1.5), map);
  const std::size_t stable = map.stableCount();
  fuseOften(60, gap(kGrey), map);
  EXPECT_EQ(map.stableCount(), stable) << "something too near hid it";
}

TEST(Gap, IsNoPixelBesideAMeasuredOne) {
  SurfelMap map{MapConfig{}};
  fuseOften(20, scene(0, 1.5), map);
  const auto odds = map.collect().odds;
  fuseOften(1, gap(kGrey, 3), map);  // through a thing that lets gaps
  EXPECT_EQ(map.collect().odds, odds);
}

}  // namespace
}  // namespace pf

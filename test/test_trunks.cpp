// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/trunks.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "segmenter_scene.hpp"

namespace pf {
namespace {

/// Cells of the figure's chest that agree with the map, before and after the trunks are doubted.
struct Doubted {
  SceneGrid grid;
  std::vector<Flatness> flatness;
  std::vector<Background> background;
  std::vector<TrackedPerson> people{1};

  explicit Doubted(const Scene& scene = Scene()) {
    sampleGrid(scene.frame, scene.frame.depth, 160, grid);
    flatness.assign(grid.size(), Flatness::none);
    background.assign(grid.size(), Background::agrees);
    people[0].person = scene.people.people[0];
    people[0].fresh = true;
  }
  long recent() {
    doubtTrunks(people, grid, flatness, background);
    return std::count(background.begin(), background.end(), Background::recent);
  }
  Keypoint& joint(Joint which) { return people[0].person.joints[static_cast<std::size_t>(which)]; }
};

constexpr int kChestCells = 12 * 30;  // between hips and shoulders, in cells of 4 pixels, about

TEST(Trunks, AMappedChestOfACertainPersonIsDoubted) {
  Doubted scene;
  EXPECT_GT(scene.recent(), kChestCells);
  const int nose = scene.grid.cellAt(320, 145), chest = scene.grid.cellAt(320, 250);
  EXPECT_EQ(scene.background[chest], Background::recent);
  EXPECT_EQ(scene.background[nose], Background::agrees);
  EXPECT_EQ(scene.background[0], Background::agrees);
}

TEST(Trunks, OnlyWhatIsSureAndSeenNowDoubts) {
  Doubted carried, guess, hidden, nowhere, apart;
  carried.people[0].fresh = false;
  guess.people[0].person.score = 0.4F;
  hidden.joint(Joint::left_hip).p = 0.0F;
  nowhere.joint(Joint::left_hip).u = 700.0F;
  const int hip = apart.grid.cellAt(apart.joint(Joint::left_hip).u, apart.joint(Joint::left_hip).v);
  apart.flatness[hip] = Flatness::small;  // the back of a chair
  for (Doubted* scene : {&carried, &guess, &hidden, &nowhere, &apart}) {
    EXPECT_EQ(scene->recent(), 0);
  }
}

TEST(Trunks, WhatStandsBeforeOrBehindTheJointsKeepsItsAgreement) {
  for (const float z : {1.7F, 2.4F}) {
    Scene scene;
    scene.frame.depth(cv::Rect(300, 220, 40, 60)).setTo(z);
    Doubted doubted(scene);
    EXPECT_GT(doubted.recent(), 0);
    EXPECT_EQ(doubted.background[doubted.grid.cellAt(320, 250)], Background::agrees) << z;
  }
}

/// A person that stands still was mapped unmasked, all but the limbs: the hole in the mask would
/// stay, and the camera follow the chest when it walks off.
TEST(Trunks, AHoleInAMaskCloses) {
  SegmenterChain segmenter;
  for (int i = 0; i < 4; ++i) {
    Scene scene;
    const cv::Rect chest(276, 205, 88, 80);
    scene.frame.depth(chest).copyTo(scene.room.depth_m(chest));
    scene.frame.stamp_ns = scene.people.stamp_ns = 1 + i * 33333333LL;
    const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
    ASSERT_FALSE(result.mask.empty());
    EXPECT_GT(iou(result.mask, scene.truth), 0.9) << i;
    ASSERT_FALSE(result.in_map_mask.empty());
    EXPECT_GT(result.in_map_mask.at<std::uint8_t>(250, 320), 0);
  }
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/mapped_people.hpp"

#include <gtest/gtest.h>

#include "segmenter_scene.hpp"

namespace pf {
namespace {

TEST(MappedPeople, WhatTheMapHasIsNoPerson) {
  // A weak detection on a wall that the map knows well.
  Scene scene;
  scene.frame.depth = scene.room.depth_m;
  scene.people.people[0].score = 0.45F;
  SegmenterChain segmenter;
  const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
  EXPECT_TRUE(result.mask.empty());
  // A strong one wins, as a person may have been missed and mapped.
  Scene mapped;
  mapped.room.depth_m = mapped.frame.depth;
  EXPECT_GT(iou(segmenter.segment(mapped.frame, mapped.people, &mapped.room).mask, mapped.truth),
            0.85);
}

TEST(MappedPeople, FindsWhereTheMapHoldsAPerson) {
  // A person stood still, was missed and mapped; behind is the wall, or nothing within reach.
  for (const float wall_z : {3.0F, 0.0F}) {
    Scene scene(2.0F, 320, wall_z);
    scene.room.depth_m = scene.frame.depth;
    const Segmentation result = SegmenterChain().segment(scene.frame, scene.people, &scene.room);
    ASSERT_FALSE(result.mask.empty()) << wall_z;
    EXPECT_EQ(result.mask.type(), CV_8UC1);
    EXPECT_GT(iou(result.mask, scene.truth), 0.8) << wall_z;
  }
  // Surfaces of a few frames only.
  Scene young;
  young.room.depth_m = young.frame.depth;
  young.room.stable = cv::Mat(480, 640, CV_8UC1, cv::Scalar(0));
  const Segmentation result = SegmenterChain().segment(young.frame, young.people, &young.room);
  EXPECT_GT(iou(result.mask, young.truth), 0.8);
}

TEST(MappedPeople, NothingOfTheMapIsAPersonsWithoutASureDetection) {
  Scene scene;
  scene.room.depth_m = scene.frame.depth;
  scene.people.people[0].score = 0.45F;
  EXPECT_TRUE(SegmenterChain().segment(scene.frame, scene.people, &scene.room).mask.empty());
  scene.people.people.clear();
  EXPECT_TRUE(SegmenterChain().segment(scene.frame, scene.people, &scene.room).mask.empty());
}

/// A person that stands still was mapped unmasked, all but the limbs: the hole in the mask would
/// stay, and the camera follow the chest when it walks off.
TEST(MappedPeople, AHoleInAMaskCloses) {
  SegmenterChain segmenter;
  for (int i = 0; i < 4; ++i) {
    Scene scene;
    const cv::Rect chest(276, 205, 88, 80);
    scene.frame.depth(chest).copyTo(scene.room.depth_m(chest));
    scene.frame.stamp_ns = scene.people.stamp_ns = 1 + i * 33333333LL;
    const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
    ASSERT_FALSE(result.mask.empty());
    EXPECT_GT(iou(result.mask, scene.truth), 0.9) << i;
  }
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/tracked_people.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "segmenter_scene.hpp"

namespace pf {
namespace {

/// Frame i of a figure that walks to the right by `step_px` a frame and is detected in the first.
Scene walkingScene(int i, int start_u, int step_px) {
  const int way = step_px * i;
  Scene scene(2.0F, start_u + way);
  cv::Mat noise(480, 640, CV_8UC3);
  cv::theRNG().state = 7;  // texture that moves with the figure, for the flow
  cv::randu(noise, 0, 60);
  cv::Mat moved(480, 640, CV_8UC3, cv::Scalar(0, 0, 0));
  noise(cv::Rect(0, 0, 640 - way, 480)).copyTo(moved(cv::Rect(way, 0, 640 - way, 480)));
  cv::Mat textured = scene.frame.color + moved;
  textured.copyTo(scene.frame.color, scene.truth);
  scene.frame.stamp_ns = 1 + i * 33333333LL;
  if (i > 0) scene.people = {scene.frame.stamp_ns, false, {}};
  return scene;
}

TEST(TrackedPeople, CarriesWalkingPeopleBetweenDetections) {
  SegmenterChain segmenter;
  for (int i = 0; i < 20; ++i) {
    const Scene scene = walkingScene(i, 250, 5);
    const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
    ASSERT_FALSE(result.mask.empty()) << i;
    EXPECT_GT(iou(result.mask, scene.truth), 0.85) << i;
    ASSERT_EQ(result.people.people.size(), 1U) << i;
    EXPECT_EQ(result.people.people[0].id, 1) << i;
  }
}

TEST(TrackedPeople, APersonLeavingTheViewIsMaskedToTheLast) {
  SegmenterChain segmenter;
  for (int i = 0; i < 20; ++i) {
    Scene scene = walkingScene(i, 510, 7);
    scene.room.depth_m.setTo(0.0F);  // the map knows nothing there
    const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
    ASSERT_FALSE(result.mask.empty()) << i;
    EXPECT_GT(iou(result.mask, scene.truth), 0.7) << i;
    ASSERT_EQ(result.people.people.size(), 1U) << i;
    for (const Keypoint& joint : result.people.people[0].joints) {
      EXPECT_TRUE(joint.p == 0.0F || joint.u < 640.0F) << i;
    }
  }
}

TEST(TrackedPeople, AJointThatLeavesTheImageGoesOnWithItsPerson) {
  constexpr int kStart_px = 510, kStep_px = 7, kFrames = 17;
  const auto left_shoulder = static_cast<std::size_t>(Joint::left_shoulder);
  const auto nose = static_cast<std::size_t>(Joint::nose);
  FlowTracker flow;
  SceneGrid grid;
  std::vector<TrackedPerson> people(1);
  for (int i = 0; i <= kFrames; ++i) {
    const Scene scene = walkingScene(i, kStart_px, kStep_px);
    flow.advance(scene.frame);
    sampleGrid(scene.frame, scene.frame.depth, 160, grid);
    if (i == 0) people[0].person = scene.people.people[0];
    if (i > 0) carryPeople(flow.images(), grid, people);
  }
  const Person& person = people[0].person;
  const int way = kStep_px * kFrames;
  ASSERT_GT(person.joints[left_shoulder].p, 0.0F);
  EXPECT_NEAR(person.joints[left_shoulder].u, kStart_px + 40 + way, 15);
  EXPECT_GT(person.joints[left_shoulder].u, 640.0F);
  EXPECT_NEAR(person.joints[nose].u, kStart_px + way, 15);
}

TEST(TrackedPeople, JointsFarOutsideTheImageAreForgotten) {
  const Scene scene;
  SceneGrid grid;
  sampleGrid(scene.frame, scene.frame.depth, 160, grid);
  Person person;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::pair<float, float>> places = {
      {0, 0},   {639, 479}, {-20, 100}, {659, 100}, {100, 499}, {-21, 100},
      {661, 1}, {1, 501},   {nan, 5},   {5, nan},   {1e30F, 5}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    person.joints[i] = {places[i].first, places[i].second, 0.5F};
  }
  dropJointsOutside(grid, 20.0F, person);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(person.joints[i].p > 0.0F, i < 5) << i;
  }
}

TEST(TrackedPeople, ForgetsPeopleThatAreGone) {
  SegmenterChain segmenter;
  Scene scene;
  segmenter.segment(scene.frame, scene.people, &scene.room);
  scene.frame.depth = scene.room.depth_m;
  scene.frame.color.setTo(cv::Scalar(200, 190, 170));
  const Segmentation result = segmenter.segment(scene.frame, {2, false, {}}, &scene.room);
  EXPECT_TRUE(result.mask.empty() || cv::countNonZero(result.mask) < 300);
}

TEST(TrackedPeople, AnotherPersonHasAnotherId) {
  SegmenterChain segmenter;
  Scene scene;
  segmenter.segment(scene.frame, scene.people, &scene.room);
  Scene other(1.5F, 500);
  other.frame.stamp_ns = 2;
  const Segmentation result = segmenter.segment(other.frame, other.people, &other.room);
  ASSERT_FALSE(result.people.people.empty());
  EXPECT_EQ(result.people.people.back().id, 2);
}

TEST(TrackedPeople, ForgetsCarriedPeopleWhenTheImageSizeChanges) {
  for (const cv::Size size : {cv::Size(640, 240), cv::Size(80, 60), cv::Size(1280, 960)}) {
    SegmenterChain segmenter;
    Scene scene;
    segmenter.segment(scene.frame, scene.people, &scene.room);
    RgbdFrame other = scene.frame;
    const double scale = size.width / 640.0;
    other.camera = {size.width,       size.height,       525 * scale, 525 * scale,
                    0.5 * size.width, 0.5 * size.height, {}};
    cv::resize(scene.frame.color, other.color, size, 0, 0, cv::INTER_NEAREST);
    cv::resize(scene.frame.depth, other.depth, size, 0, 0, cv::INTER_NEAREST);
    other.stamp_ns = 2;
    const Segmentation result = segmenter.segment(other, {2, false, {}}, nullptr);
    EXPECT_TRUE(result.people.people.empty()) << size;
    EXPECT_TRUE(result.mask.empty()) << size;
    // People are then found in the size before.
    scene.frame.stamp_ns = 3;
    EXPECT_GT(iou(segmenter.segment(scene.frame, scene.people, &scene.room).mask, scene.truth),
              0.93);
  }
}

TEST(TrackedPeople, WithoutAMapFurnitureIsNotMaskedForLong) {
  // After a person was seen, the camera is lost and looks at an armchair of the same colour.
  SegmenterChain segmenter;
  Scene scene;
  segmenter.segment(scene.frame, scene.people, &scene.room);
  Scene armchair;
  cv::Mat& chair = armchair.truth;
  cv::rectangle(chair, {210, 130}, {430, 479}, cv::Scalar(255), cv::FILLED);
  armchair.frame.depth.setTo(2.0F, chair);
  armchair.frame.color.setTo(cv::Scalar(30, 60, 120), chair);
  int masked_frames = 0;
  for (int i = 0; i < 30; ++i) {
    armchair.frame.stamp_ns = 2 + i;
    const Segmentation result =
        segmenter.segment(armchair.frame, {armchair.frame.stamp_ns, false, {}}, nullptr);
    masked_frames += !result.mask.empty() && cv::countNonZero(result.mask) > 0;
  }
  EXPECT_LE(masked_frames, 10);
}

TEST(TrackedPeople, WithoutAMapNoPersonIsSeenWhereNoneWas) {
  SegmenterChain segmenter;
  Scene scene;
  scene.frame.depth.setTo(1.5F);  // as a table before the lens
  for (int i = 0; i < 3; ++i) {
    scene.frame.stamp_ns = 1 + i;
    const Segmentation result = segmenter.segment(scene.frame, {1 + i, true, {}}, nullptr);
    EXPECT_TRUE(result.mask.empty());
    EXPECT_EQ(result.static_depth.data, scene.frame.depth.data);
  }
}

TEST(TrackedPeople, ResetForgets) {
  const Scene scene;
  SegmenterChain segmenter;
  segmenter.segment(scene.frame, scene.people, nullptr);
  segmenter.reset();
  EXPECT_TRUE(segmenter.segment(scene.frame, {2, false, {}}, nullptr).mask.empty());
}

}  // namespace
}  // namespace pf

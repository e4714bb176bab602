// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/segmenter.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <filesystem>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "posefusion/pose/detector.hpp"
#include "segmenter_scene.hpp"
#include "test_data.hpp"

namespace pf {
namespace {

TEST(Segmenter, CutsAFigureOut) {
  for (const char* energy : {"improved", "paper"}) {
    SegmentationConfig config;
    config.energy = energy;
    const Scene scene;
    SegmenterChain segmenter(config);
    const Segmentation result = segmenter.segment(scene.frame, scene.people, nullptr);
    ASSERT_FALSE(result.mask.empty());
    EXPECT_GT(iou(result.mask, scene.truth), std::string(energy) == "paper" ? 0.7 : 0.93) << energy;
    if (std::string(energy) == "improved") {
      EXPECT_EQ(cv::countNonZero((result.static_depth > 0) & (scene.truth > 0)), 0)
          << "a rim is left";
    }
    EXPECT_EQ(result.people.people.size(), 1U);
  }
}

TEST(Segmenter, WorksFromHalfAMetreToFive) {
  for (const float z : {0.8F, 1.5F, 2.5F, 4.0F, 4.8F}) {
    const Scene scene(z, 320, 6.0F);
    SegmenterChain segmenter;
    const Segmentation result = segmenter.segment(scene.frame, scene.people, nullptr);
    ASSERT_FALSE(result.mask.empty()) << z;
    EXPECT_GT(iou(result.mask, scene.truth), 0.85) << z;
  }
}

TEST(Segmenter, NoPersonCostsNothing) {
  const Scene scene;
  SegmenterChain segmenter;
  const Segmentation result = segmenter.segment(scene.frame, {1, true, {}}, &scene.room);
  EXPECT_TRUE(result.mask.empty());
  EXPECT_EQ(result.static_depth.data, scene.frame.depth.data);
}

TEST(Segmenter, DoesNotTouchItsInput) {
  const Scene scene;
  const cv::Mat before = scene.frame.depth.clone();
  SegmenterChain segmenter;
  const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
  EXPECT_EQ(cv::countNonZero(before != scene.frame.depth), 0);
  // The mask is the person, the rim is only taken from the depth.
  EXPECT_GT(cv::countNonZero(result.static_depth == 0), cv::countNonZero(result.mask));
}

TEST(Segmenter, ThePapersEnergyUsesDetectedJointsOnly) {
  SegmentationConfig config;
  config.energy = "paper";
  SegmenterChain segmenter(config);
  Scene scene;
  EXPECT_FALSE(segmenter.segment(scene.frame, scene.people, &scene.room).mask.empty());
  scene.frame.stamp_ns = 2;
  EXPECT_TRUE(segmenter.segment(scene.frame, {2, false, {}}, &scene.room).mask.empty());
}

TEST(Segmenter, PeopleCoverMostOfTheView) {
  Scene scene;
  scene.frame.depth.setTo(1.0);
  scene.frame.depth.colRange(0, 128).setTo(3.0);
  for (auto& joint : scene.people.people[0].joints) joint.u = joint.p > 0 ? joint.u + 50 : 0;
  SegmenterChain segmenter;
  const Segmentation result = segmenter.segment(scene.frame, scene.people, nullptr);
  ASSERT_FALSE(result.mask.empty());
  EXPECT_EQ(cv::countNonZero(result.mask.colRange(0, 120)), 0);
}

TEST(Segmenter, DepthThatIsMissingOrWild) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  for (const float value : {0.0F, nan, infinite, -1.0F, 100.0F}) {
    Scene scene;
    scene.frame.depth.setTo(cv::Scalar(value));
    SegmenterChain segmenter;
    const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
    EXPECT_TRUE(result.mask.empty()) << value;
    EXPECT_EQ(result.static_depth.data, scene.frame.depth.data);
  }
}

TEST(Segmenter, MillimetresAndMetresAgree) {
  const Scene metres;
  Scene millimetres;
  metres.frame.depth.convertTo(millimetres.frame.depth, CV_16UC1, 1000.0);
  const Segmentation a = SegmenterChain().segment(metres.frame, metres.people, nullptr);
  const Segmentation b = SegmenterChain().segment(millimetres.frame, millimetres.people, nullptr);
  EXPECT_EQ(cv::countNonZero(a.mask != b.mask), 0);
  EXPECT_EQ(b.static_depth.type(), CV_16UC1);
}

TEST(Segmenter, SeedsOutsideTheImage) {
  Scene scene;
  const float far = 1e30F, nan = std::numeric_limits<float>::quiet_NaN();
  auto& joints = scene.people.people[0].joints;
  joints[9] = {-50, 100, 0.9F};
  joints[10] = {320, 5000, 0.9F};
  joints[12] = {far, -far, 0.9F};
  joints[13] = {nan, nan, 0.9F};
  SegmenterChain segmenter;
  EXPECT_GT(iou(segmenter.segment(scene.frame, scene.people, nullptr).mask, scene.truth), 0.8);
  scene.people.detected = false;
  scene.people.people.clear();
  segmenter.segment(scene.frame, scene.people, nullptr);
}

TEST(Segmenter, TheDetectorsMaskShowsWhatTheJointsLeaveOut) {
  Scene scene;
  auto& joints = scene.people.people[0].joints;
  for (std::size_t j = 2; j < joints.size(); ++j) joints[j] = Keypoint();           // a head alone
  cv::rectangle(scene.truth, {265, 300}, {375, 479}, cv::Scalar(255), cv::FILLED);  // legs, hips
  scene.frame.color.setTo(cv::Scalar(200, 190, 170));  // of the wall's colour
  putBody(scene.frame.depth, scene.truth, 2.0F, 320);
  const cv::Mat without = SegmenterChain().segment(scene.frame, scene.people, nullptr).mask;
  EXPECT_LT(without.empty() ? 0.0 : iou(without, scene.truth), 0.6);
  scene.people.mask = maskOf(scene);
  const cv::Mat with = SegmenterChain().segment(scene.frame, scene.people, nullptr).mask;
  ASSERT_FALSE(with.empty());
  EXPECT_GT(iou(with, scene.truth), 0.9);
}

/// A chair hides its sitter from the chest down: hips and the line to them lie on its back.
TEST(Segmenter, TheBackOfAChairIsNoPerson) {
  for (const bool with_mask : {false, true}) {
    Scene scene;
    cv::Mat chair = cv::Mat::zeros(480, 640, CV_8UC1);
    cv::rectangle(chair, {255, 260}, {385, 400}, cv::Scalar(255), cv::FILLED);
    if (with_mask) scene.people.mask = maskOf(scene);  // that takes the chair for the person
    scene.truth.setTo(0, chair);
    for (int v = 0; v < 480; ++v) {  // it leans
      scene.frame.depth.row(v).setTo(1.9F - 0.0005F * static_cast<float>(v - 260), chair.row(v));
    }
    const Segmentation result = SegmenterChain().segment(scene.frame, scene.people, nullptr);
    ASSERT_FALSE(result.mask.empty());
    EXPECT_LT(cv::countNonZero(result.mask & chair), 0.1 * cv::countNonZero(chair)) << with_mask;
    EXPECT_GT(iou(result.mask, scene.truth), 0.8) << with_mask;
  }
}

TEST(Segmenter, WhatTheMapHoldsIsNoPersonWhateverAWeakDetectionShows) {
  Scene scene;
  scene.room.depth_m.setTo(2.0F, scene.truth);  // a thing that has always stood there
  scene.people.mask = maskOf(scene);
  scene.people.people[0].score = 0.4F;
  const Segmentation result = SegmenterChain().segment(scene.frame, scene.people, &scene.room);
  EXPECT_TRUE(result.mask.empty() || iou(result.mask, scene.truth) < 0.05);
}

/// As of part of a body at the border of the picture: one joint, a low score.
TEST(Segmenter, AGuessIsANewPersonBeforeTheMapOnly) {
  Scene scene;
  scene.people.mask = maskOf(scene);
  Person& guess = scene.people.people[0];
  for (std::size_t j = 1; j < guess.joints.size(); ++j) guess.joints[j] = Keypoint();
  guess.score = 0.13F;
  const auto masked = [&](const ModelView* map) {
    const cv::Mat mask = SegmenterChain().segment(scene.frame, scene.people, map).mask;
    return mask.empty() ? 0.0 : iou(mask, scene.truth);
  };
  EXPECT_GT(masked(&scene.room), 0.85);
  EXPECT_EQ(masked(nullptr), 0.0) << "nothing is known of what was there";
  scene.room.depth_m.setTo(2.0F, scene.truth);
  EXPECT_LT(masked(&scene.room), 0.05) << "it has always stood there";
}

TEST(Segmenter, AMirroredSceneHasAMirroredMask) {
  Scene scene(2.0F, 260);
  const Segmentation straight = SegmenterChain().segment(scene.frame, scene.people, nullptr);
  cv::Mat color, depth, mirrored;
  cv::flip(scene.frame.color, color, 1);
  cv::flip(scene.frame.depth, depth, 1);
  scene.frame.color = color;
  scene.frame.depth = depth;
  for (auto& joint : scene.people.people[0].joints) {
    if (joint.p > 0) joint.u = 639 - joint.u;
  }
  const Segmentation turned = SegmenterChain().segment(scene.frame, scene.people, nullptr);
  cv::flip(turned.mask, mirrored, 1);
  EXPECT_GT(iou(straight.mask, mirrored), 0.97);
}

TEST(Segmenter, DoesNotDependOnThreads) {
  const Scene scene;
  cv::Mat masks[2];
  for (const int threads : {1, 4}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    masks[threads > 1] = SegmenterChain().segment(scene.frame, scene.people, &scene.room).mask;
  }
  EXPECT_EQ(cv::countNonZero(masks[0] != masks[1]), 0);
}

TEST(Segmenter, FivePeople) {
  const std::string folder = testData("people_rgbd/five_people");
  const auto model = std::filesystem::path(testData("")).parent_path().parent_path() /
                     "models/tf_pose_mobilenet_v2_small.opencv.pb";
  POSEFUSION_REQUIRE_DATA(folder);
  POSEFUSION_REQUIRE_DATA(model);
  RgbdFrame frame{1, {}, cv::imread(folder + "/depth.png", cv::IMREAD_UNCHANGED), 1e-3, kCamera};
  cv::cvtColor(cv::imread(folder + "/color.png"), frame.color, cv::COLOR_BGR2RGB);
  PoseConfig pose;
  pose.detector = "network";
  pose.model = model.string();
  const People people = makePoseDetector(pose, {})->detect(frame);
  EXPECT_EQ(people.people.size(), 5U);
  const Segmentation result = SegmenterChain().segment(frame, people, nullptr);
  // Boxes on the five trunks by eye, and three on walls and floor.
  for (const cv::Rect& body :
       {cv::Rect(45, 150, 70, 200), cv::Rect(160, 170, 65, 150), cv::Rect(300, 170, 55, 130),
        cv::Rect(385, 170, 60, 150), cv::Rect(490, 140, 90, 200)}) {
    EXPECT_GT(cv::countNonZero(result.mask(body)), 0.8 * body.area()) << body;
  }
  for (const cv::Rect& room :
       {cv::Rect(150, 30, 300, 60), cv::Rect(240, 120, 30, 100), cv::Rect(250, 380, 40, 60)}) {
    EXPECT_LT(cv::countNonZero(result.mask(room)), 0.05 * room.area()) << room;
  }
}

}  // namespace
}  // namespace pf

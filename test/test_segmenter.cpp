// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"
#include "posefusion/pose/detector.hpp"
#include "posefusion/segmentation/background.hpp"
#include "posefusion/segmentation/segmenter.hpp"
#include "posefusion/segmentation/upsample.hpp"
#include "test_data.hpp"

#include <tbb/global_control.h>

namespace pf {
namespace {

const PinholeCamera kCamera{640, 480, 525, 525, 319.5, 239.5, {}};

/// A figure before a wall: a torso with a head, 1 m nearer than the wall.
struct Scene {
  RgbdFrame frame;
  cv::Mat truth = cv::Mat::zeros(480, 640, CV_8UC1);
  ModelView room;  ///< the wall alone
  People people;

  explicit Scene(float figure_z = 2.0F, int centre_u = 320, float wall_z = 3.0F) {
    cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(wall_z));
    room.camera = kCamera;
    room.depth_m = depth.clone();
    cv::Mat color(480, 640, CV_8UC3, cv::Scalar(200, 190, 170));
    const float k = 2.0F / figure_z;
    const auto at = [&](float du, float v) {
      return cv::Point2f(static_cast<float>(centre_u) + k * du, 240 + k * v);
    };
    cv::rectangle(truth, at(-55, -60), at(55, 170), cv::Scalar(255), cv::FILLED);
    cv::circle(truth, at(0, -95), cvRound(32 * k), cv::Scalar(255), cv::FILLED);
    depth.setTo(figure_z, truth);
    color.setTo(cv::Scalar(30, 60, 120), truth);
    frame = {1, color, depth, 1e-3, kCamera};
    Person person;
    person.score = 1.0F;
    const auto put = [&](Joint joint, float du, float v) {
      const cv::Point2f p = at(du, v);
      person.joints[static_cast<int>(joint)] = {p.x, p.y, 0.8F};
    };
    put(Joint::nose, 0, -95);
    put(Joint::neck, 0, -50);
    put(Joint::right_shoulder, -40, -45);
    put(Joint::left_shoulder, 40, -45);
    put(Joint::right_hip, -30, 100);
    put(Joint::left_hip, 30, 100);
    people = {1, true, {person}};
  }
};

/// A body is no board: it is round.
void makeRound(Scene& scene, int centre_u) {
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      if (scene.truth.at<std::uint8_t>(v, u) == 0) continue;
      const float aside = static_cast<float>(u - centre_u) / 55.0F;
      scene.frame.depth.at<float>(v, u) += 0.15F * aside * aside;
    }
  }
}

double iou(const cv::Mat& a, const cv::Mat& b) {
  return static_cast<double>(cv::countNonZero(a & b)) / std::max(1, cv::countNonZero(a | b));
}

/// A segmenter with the optical flow that its owner keeps.
class Chain {
 public:
  explicit Chain(const SegmentationConfig& config = {}) : segmenter_(config) {}

  Segmentation segment(const RgbdFrame& frame, const People& people, const ModelView* background) {
    flow_.advance(frame);
    return segmenter_.segment(frame, flow_, people, background);
  }
  void reset() { segmenter_.reset(); }

 private:
  FlowTracker flow_;
  PeopleSegmenter segmenter_;
};

TEST(Segmenter, CutsAFigureOut) {
  for (const char* energy : {"improved", "paper"}) {
    SegmentationConfig config;
    config.energy = energy;
    const Scene scene;
    Chain segmenter(config);
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
    Chain segmenter;
    const Segmentation result = segmenter.segment(scene.frame, scene.people, nullptr);
    ASSERT_FALSE(result.mask.empty()) << z;
    EXPECT_GT(iou(result.mask, scene.truth), 0.85) << z;
  }
}

TEST(Segmenter, NobodyCostsNothing) {
  const Scene scene;
  Chain segmenter;
  const Segmentation result = segmenter.segment(scene.frame, {1, true, {}}, &scene.room);
  EXPECT_TRUE(result.mask.empty());
  EXPECT_EQ(result.static_depth.data, scene.frame.depth.data);
}

TEST(Segmenter, DoesNotTouchItsInput) {
  const Scene scene;
  const cv::Mat before = scene.frame.depth.clone();
  Chain segmenter;
  const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
  EXPECT_EQ(cv::countNonZero(before != scene.frame.depth), 0);
  // The mask is the person, the rim is only taken from the depth.
  EXPECT_GT(cv::countNonZero(result.static_depth == 0), cv::countNonZero(result.mask));
}

TEST(Segmenter, CarriesPeopleWhoWalkUnseen) {
  Chain segmenter;
  for (int i = 0; i < 20; ++i) {
    Scene scene(2.0F, 250 + 5 * i);
    cv::Mat noise(480, 640, CV_8UC3);
    cv::theRNG().state = 7;  // texture that moves with the figure, for the flow
    cv::randu(noise, 0, 60);
    cv::Mat moved(480, 640, CV_8UC3, cv::Scalar(0, 0, 0));
    noise(cv::Rect(0, 0, 640 - 5 * i, 480)).copyTo(moved(cv::Rect(5 * i, 0, 640 - 5 * i, 480)));
    cv::Mat textured = scene.frame.color + moved;
    textured.copyTo(scene.frame.color, scene.truth);
    scene.frame.stamp_ns = 1 + i * 33333333LL;
    if (i > 0) scene.people = {scene.frame.stamp_ns, false, {}};
    const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
    ASSERT_FALSE(result.mask.empty()) << i;
    EXPECT_GT(iou(result.mask, scene.truth), 0.85) << i;
  }
}

TEST(Segmenter, ForgetsWhoIsGone) {
  Chain segmenter;
  Scene scene;
  segmenter.segment(scene.frame, scene.people, &scene.room);
  scene.frame.depth = scene.room.depth_m;
  scene.frame.color.setTo(cv::Scalar(200, 190, 170));
  const Segmentation result = segmenter.segment(scene.frame, {2, false, {}}, &scene.room);
  EXPECT_TRUE(result.mask.empty() || cv::countNonZero(result.mask) < 300);
}

TEST(Segmenter, ForgetsCarriedPeopleWhenTheImageSizeChanges) {
  for (const cv::Size size : {cv::Size(640, 240), cv::Size(80, 60), cv::Size(1280, 960)}) {
    Chain segmenter;
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
    // And people are found as ever in the size before.
    scene.frame.stamp_ns = 3;
    EXPECT_GT(iou(segmenter.segment(scene.frame, scene.people, &scene.room).mask, scene.truth),
              0.93);
  }
}

TEST(Segmenter, WhatTheMapHasIsNobody) {
  // A weak detection on a wall that the map knows well.
  Scene scene;
  scene.frame.depth = scene.room.depth_m;
  scene.people.people[0].score = 0.45F;
  Chain segmenter;
  const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
  EXPECT_TRUE(result.mask.empty());
  // A sure one wins, for somebody may have been missed and mapped.
  Scene mapped;
  mapped.room.depth_m = mapped.frame.depth;
  EXPECT_GT(iou(segmenter.segment(mapped.frame, mapped.people, &mapped.room).mask, mapped.truth),
            0.85);
}

TEST(Segmenter, TellsWhereTheMapHoldsAPerson) {
  // Somebody stood still, was missed and mapped; behind is the wall, or nothing within reach.
  for (const float wall_z : {3.0F, 0.0F}) {
    Scene scene(2.0F, 320, wall_z);
    makeRound(scene, 320);
    scene.room.depth_m = scene.frame.depth;
    const Segmentation result = Chain().segment(scene.frame, scene.people, &scene.room);
    ASSERT_FALSE(result.in_map_mask.empty()) << wall_z;
    EXPECT_EQ(result.in_map_mask.type(), CV_8UC1);
    EXPECT_GT(iou(result.in_map_mask, scene.truth), 0.8) << wall_z;
    EXPECT_EQ(cv::countNonZero(result.in_map_mask & ~result.mask), 0);
  }
  // Surfaces of a few frames only.
  Scene young;
  makeRound(young, 320);
  young.room.depth_m = young.frame.depth;
  young.room.stable = cv::Mat(480, 640, CV_8UC1, cv::Scalar(0));
  const Segmentation result = Chain().segment(young.frame, young.people, &young.room);
  EXPECT_GT(iou(result.in_map_mask, young.truth), 0.8);
}

TEST(Segmenter, NothingOfTheMapIsAPersonsWithoutASureDetection) {
  Scene scene;
  EXPECT_TRUE(Chain().segment(scene.frame, scene.people, nullptr).in_map_mask.empty());
  EXPECT_TRUE(Chain().segment(scene.frame, scene.people, &scene.room).in_map_mask.empty());
  scene.room.depth_m = scene.frame.depth;
  scene.people.people[0].score = 0.45F;
  EXPECT_TRUE(Chain().segment(scene.frame, scene.people, &scene.room).in_map_mask.empty());
  scene.people.people.clear();
  EXPECT_TRUE(Chain().segment(scene.frame, scene.people, &scene.room).in_map_mask.empty());
}

TEST(Segmenter, WithoutAMapFurnitureIsNotMaskedForLong) {
  // A person is known; then the camera is lost and looks at an armchair of the same colour.
  Chain segmenter;
  Scene scene;
  segmenter.segment(scene.frame, scene.people, &scene.room);
  Scene armchair;
  cv::Mat& chair = armchair.truth;
  cv::rectangle(chair, {210, 130}, {430, 479}, cv::Scalar(255), cv::FILLED);
  armchair.frame.depth.setTo(2.0F, chair);
  armchair.frame.color.setTo(cv::Scalar(30, 60, 120), chair);
  makeRound(armchair, 320);
  int masked_frames = 0;
  for (int i = 0; i < 30; ++i) {
    armchair.frame.stamp_ns = 2 + i;
    const Segmentation result =
        segmenter.segment(armchair.frame, {armchair.frame.stamp_ns, false, {}}, nullptr);
    masked_frames += !result.mask.empty() && cv::countNonZero(result.mask) > 0;
  }
  EXPECT_LE(masked_frames, 10);
}

TEST(Segmenter, WithoutAMapNobodyIsSeenWhereNobodyWas) {
  Chain segmenter;
  Scene scene;
  scene.frame.depth.setTo(1.5F);  // as a table before the lens
  for (int i = 0; i < 3; ++i) {
    scene.frame.stamp_ns = 1 + i;
    const Segmentation result = segmenter.segment(scene.frame, {1 + i, true, {}}, nullptr);
    EXPECT_TRUE(result.mask.empty());
    EXPECT_EQ(result.static_depth.data, scene.frame.depth.data);
  }
}

TEST(Segmenter, ThePapersEnergyKnowsDetectedJointsOnly) {
  SegmentationConfig config;
  config.energy = "paper";
  Chain segmenter(config);
  Scene scene;
  EXPECT_FALSE(segmenter.segment(scene.frame, scene.people, &scene.room).mask.empty());
  scene.frame.stamp_ns = 2;
  EXPECT_TRUE(segmenter.segment(scene.frame, {2, false, {}}, &scene.room).mask.empty());
}

TEST(MotionPredictor, StartsFromTheViewsOwnStamp) {
  // The camera moves steadily; the views come some frames late, now and then one is missing.
  const auto poseAt = [](std::int64_t frame) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() =
        Eigen::AngleAxisd(0.02 * static_cast<double>(frame), Eigen::Vector3d::UnitY()).matrix();
    T.translation() = T.linear() * Eigen::Vector3d(0.3, 0, 0);  // about a fixed centre
    return T;
  };
  constexpr std::int64_t kPeriod_ns = 33333333;
  for (const int late : {1, 2, 3}) {
    MotionPredictor predictor;
    for (std::int64_t frame = 10; frame < 30; ++frame) {
      const std::int64_t seen = (frame % 7 == 0 ? frame - 1 : frame) - late;
      ModelView view;
      view.stamp_ns = seen * kPeriod_ns;
      view.T_map_camera = poseAt(seen);
      const Eigen::Isometry3d T = predictor.predict(view, frame * kPeriod_ns);
      if (frame < 12) continue;
      const Eigen::Isometry3d truth = poseAt(seen).inverse() * poseAt(frame);
      EXPECT_LT((T.matrix() - truth.matrix()).norm(), 2e-3) << late << " " << frame;
    }
  }
}

TEST(MotionPredictor, KeepsThePoseWhereNoMotionIsKnown) {
  MotionPredictor predictor;
  ModelView view;
  view.stamp_ns = 5;
  view.T_map_camera.translation() = Eigen::Vector3d(1, 2, 3);
  EXPECT_TRUE(predictor.predict(view, 6).isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_TRUE(predictor.predict(view, 7).isApprox(Eigen::Isometry3d::Identity()));
}

TEST(Segmenter, PeopleCoverMostOfTheView) {
  Scene scene;
  scene.frame.depth.setTo(1.0);
  scene.frame.depth.colRange(0, 128).setTo(3.0);
  for (auto& joint : scene.people.people[0].joints) joint.u = joint.p > 0 ? joint.u + 50 : 0;
  Chain segmenter;
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
    Chain segmenter;
    const Segmentation result = segmenter.segment(scene.frame, scene.people, &scene.room);
    EXPECT_TRUE(result.mask.empty()) << value;
    EXPECT_EQ(result.static_depth.data, scene.frame.depth.data);
  }
}

TEST(Segmenter, MillimetresAndMetresAgree) {
  const Scene metres;
  Scene millimetres;
  metres.frame.depth.convertTo(millimetres.frame.depth, CV_16UC1, 1000.0);
  const Segmentation a = Chain().segment(metres.frame, metres.people, nullptr);
  const Segmentation b = Chain().segment(millimetres.frame, millimetres.people, nullptr);
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
  Chain segmenter;
  EXPECT_GT(iou(segmenter.segment(scene.frame, scene.people, nullptr).mask, scene.truth), 0.8);
  scene.people.detected = false;
  scene.people.people.clear();
  segmenter.segment(scene.frame, scene.people, nullptr);
}

TEST(Segmenter, AMirroredSceneHasAMirroredMask) {
  Scene scene(2.0F, 260);
  const Segmentation straight = Chain().segment(scene.frame, scene.people, nullptr);
  cv::Mat color, depth, mirrored;
  cv::flip(scene.frame.color, color, 1);
  cv::flip(scene.frame.depth, depth, 1);
  scene.frame.color = color;
  scene.frame.depth = depth;
  for (auto& joint : scene.people.people[0].joints) {
    if (joint.p > 0) joint.u = 639 - joint.u;
  }
  const Segmentation turned = Chain().segment(scene.frame, scene.people, nullptr);
  cv::flip(turned.mask, mirrored, 1);
  EXPECT_GT(iou(straight.mask, mirrored), 0.97);
}

TEST(Segmenter, DoesNotDependOnThreads) {
  const Scene scene;
  cv::Mat masks[2];
  for (const int threads : {1, 4}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    masks[threads > 1] = Chain().segment(scene.frame, scene.people, &scene.room).mask;
  }
  EXPECT_EQ(cv::countNonZero(masks[0] != masks[1]), 0);
}

TEST(Segmenter, ResetForgets) {
  const Scene scene;
  Chain segmenter;
  segmenter.segment(scene.frame, scene.people, nullptr);
  segmenter.reset();
  EXPECT_TRUE(segmenter.segment(scene.frame, {2, false, {}}, nullptr).mask.empty());
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
  pose.model = model.string();
  const People people = makePoseDetector(pose, {})->detect(frame);
  EXPECT_EQ(people.people.size(), 5U);
  const Segmentation result = Chain().segment(frame, people, nullptr);
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

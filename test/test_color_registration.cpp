// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/color_registration.hpp"

#include <gtest/gtest.h>

#include <random>

#include "posefusion/calibration/color_estimate.hpp"
#include "posefusion/calibration/color_learner.hpp"
#include "posefusion/io/frame_source.hpp"
#include "test_data.hpp"

namespace pf {
namespace {

constexpr double kWall_m = 4.0;
const PinholeCamera kDepthCamera{320, 240, 290, 290, 159.5, 119.5};
/// As of a Kinect whose images are not registered: another lens, and 25 mm beside.
const ColorCamera kBeside{260, 260, 161, 118, -0.025};

/// Boards of one grey before a wall of another.
struct Boards {
  struct Board {
    double x, y, z, half;
    std::uint8_t grey;
  };
  std::vector<Board> boards;

  explicit Boards(unsigned seed) {
    std::mt19937 random(seed);
    const auto in = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int i = 0; i < 12; ++i) {
      boards.push_back({in(-1.5, 1.5), in(-1.1, 1.1), in(0.9, 3.2), in(0.1, 0.4),
                        static_cast<std::uint8_t>(in(0, 2) < 1 ? in(20, 80) : in(170, 240))});
    }
  }

  /// Depth (m) and grey of what is seen along a ray from a camera that is so far right.
  std::pair<double, std::uint8_t> seen(double slope_x, double slope_y, double right_m) const {
    std::pair<double, std::uint8_t> nearest{kWall_m, 120};
    for (const Board& b : boards) {
      const bool hits = std::abs(right_m + slope_x * b.z - b.x) < b.half &&
                        std::abs(slope_y * b.z - b.y) < b.half;
      if (hits && b.z < nearest.first) nearest = {b.z, b.grey};
    }
    return nearest;
  }
};

/// What a pair of cameras sees of them.
RgbdFrame frameOf(const Boards& boards, const ColorCamera& color, std::int64_t stamp_ns = 0) {
  RgbdFrame frame;
  frame.stamp_ns = stamp_ns;
  frame.camera = kDepthCamera;
  frame.depth_unit_m = 1e-3;
  frame.depth.create(240, 320, CV_16UC1);
  frame.color.create(240, 320, CV_8UC3);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const Eigen::Vector3d ray = kDepthCamera.unproject(u, v, 1.0);
      const double z = boards.seen(ray.x(), ray.y(), 0.0).first;
      frame.depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(1000 * z);
      const auto grey =
          boards.seen((u - color.cx) / color.fx, (v - color.cy) / color.fy, -color.depth_right_m)
              .second;
      frame.color.at<cv::Vec3b>(v, u) = cv::Vec3b::all(grey);
    }
  }
  return frame;
}

std::vector<EdgeView> viewsBy(const ColorCamera& color, unsigned count) {
  std::vector<EdgeView> views;
  for (unsigned i = 0; i < count; ++i) views.push_back(edgeView(frameOf(Boards(i), color)));
  return views;
}

/// Part of the pixels whose colour is that of another board.
double wrongPart(const RgbdFrame& frame, const cv::Mat& expected) {
  cv::Mat difference;
  cv::absdiff(frame.color, expected, difference);
  std::vector<cv::Mat> channels;
  cv::split(difference, channels);
  return cv::countNonZero(channels[0] > 20) / static_cast<double>(expected.total());
}

TEST(ColorRegistration, GivesEachPixelOfDepthItsColour) {
  for (const double right_m : {-0.025, 0.025}) {
    ColorCamera camera = kBeside;
    camera.depth_right_m = right_m;
    const Boards boards(3);
    const RgbdFrame frame = frameOf(boards, camera);
    const cv::Mat expected = frameOf(boards, registeredTo(kDepthCamera)).color;
    EXPECT_GT(wrongPart(frame, expected), 0.1);
    const RgbdFrame registered = ColorRegistration(camera).registered(frame);
    // Edges are interpolated.
    EXPECT_LT(wrongPart(registered, expected), 0.02) << right_m;
    EXPECT_EQ(registered.depth.data, frame.depth.data);
  }
}

TEST(ColorRegistration, WhatHasNoDepthTakesThatOfWhatIsFartherBesideIt) {
  const Boards boards(3);
  RgbdFrame frame = frameOf(boards, kBeside);
  const cv::Mat expected = frameOf(boards, registeredTo(kDepthCamera)).color;
  std::mt19937 random(1);
  for (int i = 0; i < 4000; ++i) frame.depth.at<std::uint16_t>(random() % 240, random() % 320) = 0;
  frame.depth.row(100) = 0;
  EXPECT_LT(wrongPart(ColorRegistration(kBeside).registered(frame), expected), 0.03);
}

TEST(ColorRegistration, ASpeckleOfNearDepthHidesNothing) {
  const Boards boards(3);
  RgbdFrame frame = frameOf(boards, kBeside);
  const cv::Mat before = ColorRegistration(kBeside).registered(frame).color.clone();
  for (int v = 5; v < 240; v += 10) frame.depth.at<std::uint16_t>(v, 160) = 150;
  cv::Mat changed;
  cv::absdiff(ColorRegistration(kBeside).registered(frame).color, before, changed);
  EXPECT_LT(cv::countNonZero(changed.reshape(1) > 20), 3 * 24 * 3);
}

TEST(ColorEstimate, FindsTheCameraByStepsOfDepth) {
  const ColorEstimate estimate = estimateColorCamera(viewsBy(kBeside, 24), kDepthCamera);
  EXPECT_EQ(estimate.doubt, "");
  EXPECT_NEAR(estimate.camera.fx, kBeside.fx, 1.5);
  EXPECT_NEAR(estimate.camera.depth_right_m, kBeside.depth_right_m, 0.004);
  EXPECT_GT(estimate.offset_px, 5.0);
  // What it says of any place matters, not its numbers.
  for (const double z : {1.0, 2.0, 4.0}) {
    for (const double u : {20.0, 160.0, 300.0}) {
      const Eigen::Vector2d off = estimate.camera.pixel(kDepthCamera, u, 60, 1 / z) -
                                  kBeside.pixel(kDepthCamera, u, 60, 1 / z);
      EXPECT_LT(off.norm(), 1.0) << u << " at " << z;
    }
  }
}

TEST(ColorEstimate, ColourThatLiesOverDepthIsLeft) {
  const ColorEstimate estimate =
      estimateColorCamera(viewsBy(registeredTo(kDepthCamera), 24), kDepthCamera);
  EXPECT_NE(estimate.doubt.find("colour lies over depth"), std::string::npos) << estimate.doubt;
  EXPECT_LT(estimate.offset_px, 1.0);
}

TEST(ColorEstimate, ColourThatHasNothingToDoWithDepthIsLeft) {
  std::vector<EdgeView> views = viewsBy(kBeside, 24);
  for (unsigned i = 0; i < views.size(); ++i) {
    views[i].strength = edgeView(frameOf(Boards(100 + i), kBeside)).strength;
  }
  EXPECT_NE(estimateColorCamera(views, kDepthCamera).doubt, "");
}

TEST(ColorEstimate, AWallSaysNothing) {
  Boards wall(1);
  wall.boards.clear();
  const std::vector<EdgeView> views(24, edgeView(frameOf(wall, kBeside)));
  EXPECT_EQ(estimateColorCamera(views, kDepthCamera).doubt,
            "0 views have steps of depth, expected 16 or more");
}

const CalibrationConfig kLearns{"learn", "learn"};

/// Frames of one camera; what the learner makes of them.
std::vector<cv::Mat> learned(ColorLearner& learner, const ColorCamera& color, int frames) {
  std::vector<cv::Mat> pictures;
  for (int i = 0; i < frames; ++i) {
    const RgbdFrame frame = frameOf(Boards(static_cast<unsigned>(i)), color, i * 60'000'000LL);
    const RgbdFrame out = learner.registered(frame);
    const bool is_same = out.color.data == frame.color.data;
    pictures.push_back(is_same ? cv::Mat() : out.color);
  }
  return pictures;
}

TEST(ColorLearner, RegistersFromAFrameOnThatTimeDoesNotDecide) {
  ColorLearner a(kLearns), b(kLearns);
  const auto first = learned(a, kBeside, 50), second = learned(b, kBeside, 50);
  EXPECT_TRUE(first[39].empty());
  ASSERT_FALSE(first[41].empty());
  EXPECT_EQ(a.estimate()->doubt, "");
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].size(), second[i].size()) << i;
    if (first[i].empty()) continue;
    EXPECT_EQ(cv::norm(first[i], second[i], cv::NORM_INF), 0.0) << i;
  }
}

TEST(ColorLearner, LeavesWhatIsRegisteredAndWhatItShallNotTouch) {
  ColorLearner learner(kLearns), tells(CalibrationConfig{}),
      off(CalibrationConfig{"learn", "none"});
  for (const cv::Mat& picture : learned(learner, registeredTo(kDepthCamera), 50)) {
    EXPECT_TRUE(picture.empty());
  }
  EXPECT_TRUE(learner.estimate().has_value());
  for (const cv::Mat& picture : learned(tells, kBeside, 50)) EXPECT_TRUE(picture.empty());
  EXPECT_EQ(tells.estimate()->doubt, "");
  for (const cv::Mat& picture : learned(off, kBeside, 50)) EXPECT_TRUE(picture.empty());
  EXPECT_FALSE(off.estimate().has_value());
}

TEST(ColorLearner, UsesWhatItIsGivenFromTheFirstFrameOn) {
  ColorLearner learner;
  learner.give(kBeside);
  const RgbdFrame frame = frameOf(Boards(3), kBeside);
  const cv::Mat expected = ColorRegistration(kBeside).registered(frame).color;
  EXPECT_EQ(cv::norm(learner.registered(frame).color, expected, cv::NORM_INF), 0.0);
  EXPECT_FALSE(learner.estimate().has_value());
}

TEST(ColorLearner, BeginsAnewWithAnotherCamera) {
  ColorLearner learner(kLearns);
  learned(learner, kBeside, 45);
  ASSERT_TRUE(learner.estimate().has_value());
  RgbdFrame other = frameOf(Boards(1), kBeside, 5'000'000'000LL);
  other.camera.fx = 300;
  EXPECT_EQ(learner.registered(other).color.data, other.color.data);
  EXPECT_FALSE(learner.estimate().has_value());
}

TEST(ColorEstimate, KnowsTheKinectOfARealRecording) {
  const std::string folder = testData("kitchen_static");
  POSEFUSION_REQUIRE_DATA(folder);
  const auto source = openTumFolder(folder);
  ColorLearner learner(kLearns);
  while (auto next = source->next()) {
    learner.registered(next->frame);
    if (learner.estimate()) break;
  }
  ASSERT_TRUE(learner.estimate().has_value());
  EXPECT_EQ(learner.estimate()->doubt, "");
  // Its colour camera has a focal length of 525 px, and is 25 mm beside.
  EXPECT_NEAR(learner.estimate()->camera.fx, 525, 6);
  EXPECT_NEAR(learner.estimate()->camera.depth_right_m, -0.025, 0.012);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
// A bare wall shows nothing but noise.
#include "posefusion/frame/picture_noise.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "posefusion/frame/flow.hpp"
#include "posefusion/loop/keyframe_pair.hpp"

namespace pf {
namespace {

const cv::Size kSize(320, 240);
constexpr double kNoise = 3.0;  // grey levels

cv::Mat textured() {
  cv::Mat texture(kSize, CV_32FC1);
  cv::RNG(5).fill(texture, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(texture, texture, {}, 3.0);
  cv::normalize(texture, texture, 20, 230, cv::NORM_MINMAX);
  return texture;
}

/// A wall with a gradient from side to side, and this noise.
cv::Mat bareWall(std::uint64_t seed, double noise = kNoise) {
  cv::Mat wall(kSize, CV_32FC1), errors(kSize, CV_32FC1);
  for (int u = 0; u < kSize.width; ++u) wall.col(u).setTo(100 + 0.1 * u);
  cv::RNG(seed).fill(errors, cv::RNG::NORMAL, 0, noise);
  return wall + errors;
}

TEST(PictureNoise, IsThatOfTheQuietPlaces) {
  for (const double noise : {1.0, 3.0, 8.0}) {
    EXPECT_NEAR(pictureNoise(bareWall(1, noise)), noise, 0.15 * noise);
    cv::Mat part = bareWall(2, noise);
    const cv::Rect left(0, 0, kSize.width / 2, kSize.height);
    cv::Mat sum = textured() + part;
    sum(left).copyTo(part(left));
    EXPECT_NEAR(pictureNoise(part), noise, 0.2 * noise) << "half of it is textured";
  }
  EXPECT_NEAR(pictureNoise(bareWall(1, 0)), 0, 1e-3);
  cv::Mat bytes;
  bareWall(1).convertTo(bytes, CV_8U);
  EXPECT_NEAR(pictureNoise(bytes), kNoise, 0.15 * kNoise);
  EXPECT_EQ(pictureNoise(cv::Mat(8, 8, CV_8UC1, cv::Scalar(7))), 0) << "too small to measure";
}

RgbdFrame frameOf(const cv::Mat& grey, std::int64_t stamp_ns) {
  RgbdFrame frame;
  frame.stamp_ns = stamp_ns;
  grey.convertTo(frame.color, CV_8U);
  cv::cvtColor(frame.color, frame.color, cv::COLOR_GRAY2RGB);
  frame.depth = cv::Mat(kSize, CV_16UC1, cv::Scalar(700));
  frame.camera = {kSize.width, kSize.height, 262.5, 262.5, 159.5, 119.5};
  return frame;
}

TEST(PictureNoise, HasNoCornersThatCouldBeFollowed) {
  FlowTracker on_wall, on_picture;
  const auto lastOf = [](FlowTracker& tracker, const cv::Mat& first, const cv::Mat& second) {
    tracker.advance(frameOf(first, 1));
    return tracker.advance(frameOf(second, 2)).before.size();
  };
  EXPECT_LT(lastOf(on_wall, bareWall(1), bareWall(2)), 12U) << "fewer than a motion takes";
  const cv::Mat a = textured() + bareWall(1) - 100, b = textured() + bareWall(2) - 100;
  EXPECT_GT(lastOf(on_picture, a, b), 100U);
}

/// A picture aligned with one of before, at the same place.
TrackingResult aligned(const cv::Mat& before, const cv::Mat& after) {
  FrameConfig config;
  config.shrink = 1;
  const auto pictureOf = [&](const cv::Mat& grey) {
    WorkingFrame frame;
    frame.assign(frameOf(grey, 1), cv::Mat(), config);
    KeyframePicture picture;
    picture.assign(keyframeView(frame, 0, {}, true), DepthSensor{});
    return picture;
  };
  const KeyframePicture model = pictureOf(before), frame = pictureOf(after);
  TrackingStart start;
  start.prior.covariance = independentCovariance(0.1, 0.1);
  return track(frame.frame, model.points, start, TrackingConfig{});
}

TEST(PictureNoise, GivesNoMotionAlongAWall) {
  const TrackingResult wall = aligned(bareWall(1), bareWall(2));
  EXPECT_EQ(wall.free_directions, 3) << "along it, and about its normal";
  const TrackingResult picture =
      aligned(textured() + bareWall(1) - 100, textured() + bareWall(2) - 100);
  EXPECT_EQ(picture.free_directions, 0);
  EXPECT_GT(wall.covariance(0, 0), 100 * picture.covariance(0, 0));
}

}  // namespace
}  // namespace pf

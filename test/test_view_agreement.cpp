// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "posefusion/frame/depth_filter.hpp"
#include "posefusion/tracking/view_agreement.hpp"

namespace pf {
namespace {

// Two walls of a corner as a small picture has them: nothing is averaged, normals are noise.
const PinholeCamera kCamera{320, 240, 262, 262, 159.5, 119.5, {}};
constexpr float kCorner_m = 4.0F;
// Structured light matches patches: noise is the same in so many pixels across.
constexpr int kPatch = 4;
constexpr double kSigmas = 1.5;

float cornerDepth(int u) {
  const float ray = (static_cast<float>(u) - static_cast<float>(kCamera.cx)) / 262.0F;
  return kCorner_m / (1.0F + std::abs(ray));  // both walls come towards the camera at 45 degrees
}

cv::Mat corner() {
  cv::Mat depth_m(kCamera.height, kCamera.width, CV_32FC1);
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) depth_m.at<float>(v, u) = cornerDepth(u);
  }
  return depth_m;
}

/// The map has no noise; `turned`: its normals are those of walls that lean the other way.
ModelView modelOf(const cv::Mat& depth_m, bool turned = false) {
  ModelView view;
  view.camera = kCamera;
  view.depth_m = depth_m;
  for (cv::Mat* plane : {&view.normal_x, &view.normal_y, &view.normal_z, &view.intensity}) {
    *plane = cv::Mat::zeros(depth_m.size(), CV_32FC1);
  }
  const float half = std::sqrt(0.5F);
  view.normal_z.setTo(-half);
  view.normal_x.colRange(0, 160).setTo(turned ? -half : half);
  view.normal_x.colRange(160, 320).setTo(turned ? half : -half);
  return view;
}

WorkingFrame frameWithNoise(const cv::Mat& depth_m) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  RgbdFrame frame;
  frame.camera = kCamera;
  frame.color = cv::Mat(depth_m.size(), CV_8UC3, cv::Scalar::all(100));
  frame.depth = depth_m.clone();
  const DepthSensor sensor;
  for (int v = 0; v < frame.depth.rows; v += kPatch) {
    for (int u = 0; u < frame.depth.cols; u += kPatch) {
      cv::Mat patch = frame.depth(cv::Rect(u, v, kPatch, kPatch));
      patch += kSigmas * sensor.sigma(patch.at<float>(0, 0)) * normal(random);
    }
  }
  FrameConfig config;
  config.shrink = 1;
  WorkingFrame made;
  made.assign(frame, cv::Mat(), config);
  return made;
}

TEST(ViewAgreement, NoiseOfTheNormalsDoesNotCountAgainstAPlace) {
  const ViewAgreement agreement = compareViews(frameWithNoise(corner()), modelOf(corner()));
  EXPECT_GT(agreement.overlap, 0.95);
  EXPECT_GT(agreement.agreeing, 0.95);
  EXPECT_LT(agreement.hidden + agreement.seen_through, 0.05);
}

TEST(ViewAgreement, SurfacesThatFaceElsewhereDoNotAgreeThoughTheyAreAsFar) {
  const ViewAgreement agreement = compareViews(frameWithNoise(corner()), modelOf(corner(), true));
  EXPECT_LT(agreement.agreeing, 0.1);
}

TEST(ViewAgreement, WhatStandsBeforeTheMapHidesItAndWhatIsMissingIsSeenThrough) {
  const cv::Mat empty = corner();
  cv::Mat with_box = corner();
  with_box(cv::Rect(32, 60, 64, 96)).setTo(2.0F);
  const double part = 64.0 * 96.0 / (320.0 * 240.0);
  const ViewAgreement came = compareViews(frameWithNoise(with_box), modelOf(empty));
  EXPECT_NEAR(came.hidden, part, 0.02);
  EXPECT_LT(came.seen_through, 0.01);
  const ViewAgreement went = compareViews(frameWithNoise(empty), modelOf(with_box));
  EXPECT_NEAR(went.seen_through, part, 0.02);
  EXPECT_LT(went.hidden, 0.01);
}

}  // namespace
}  // namespace pf

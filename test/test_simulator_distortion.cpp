// SPDX-License-Identifier: BSD-3-Clause
// The systematic errors of a depth camera have the shapes that their settings name.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "depth_wall.hpp"
#include "posefusion/calibration/depth_correction.hpp"
#include "simulator/depth_distortion.hpp"

namespace pf::simulator {
namespace {

/// Millimetres off (CV_32FC1) before a wall; 0 where there is no depth.
cv::Mat errorMm(const DepthConfig& config, float z_m, double time_s = 0.0) {
  const cv::Mat depth = sense(wall(z_m), config, 1U, time_s);
  cv::Mat off;
  depth.convertTo(off, CV_32F, 1.0, -1000.0 * static_cast<double>(z_m));
  off.setTo(0, depth == 0);
  return off;
}

double meanMm(const DepthConfig& config, float z_m, double time_s) {
  return cv::mean(errorMm(config, z_m, time_s)(cv::Rect(100, 0, 540, 480)))[0];
}

TEST(SimulatorDistortion, StripesAreStepsBetweenBandsOfTheirWidth) {
  DepthConfig config = quietDepth();
  config.stripe_mm = 8.0;
  config.stripe_px = 50;
  cv::Mat off;
  cv::reduce(errorMm(config, 2.0F), off, 0, cv::REDUCE_AVG);
  int steps = 0;
  for (int col = 1; col < off.cols; ++col) {
    const float step = std::abs(off.at<float>(col) - off.at<float>(col - 1));
    if (step < 0.5F) continue;
    EXPECT_EQ(col % 50, 0) << step;
    ++steps;
  }
  EXPECT_GE(steps, 8) << "of 12";
  EXPECT_LT(cv::norm(off, cv::NORM_INF), 8.6);
  EXPECT_GT(cv::norm(off, cv::NORM_INF), 4.0);
  cv::Mat far;
  cv::reduce(errorMm(config, 4.0F), far, 0, cv::REDUCE_AVG);
  EXPECT_NEAR(cv::norm(far, cv::NORM_INF) / cv::norm(off, cv::NORM_INF), 4.0, 0.5) << "with z^2";
}

TEST(SimulatorDistortion, ABowlGrowsWithTheRadiusAndItsPowerOfTheDistance) {
  for (const int power : {1, 2}) {
    DepthConfig config = quietDepth();
    config.bowl_mm = 20.0;
    config.bowl_power = power;
    const cv::Mat off = errorMm(config, 2.0F);
    EXPECT_NEAR(off.at<float>(240, 320), 0.0, 0.6);
    EXPECT_NEAR(off.at<float>(479, 639), 20.0, 0.9);
    EXPECT_NEAR(off.at<float>(240, 480), 20.0 * 160 * 160 / (320.0 * 320 + 240 * 240), 0.9);
    EXPECT_NEAR(errorMm(config, 4.0F).at<float>(479, 639), 20.0 * std::pow(2.0, power), 2.5);
  }
}

TEST(SimulatorDistortion, AColdCameraIsOffAndWarmsUp) {
  DepthConfig config = quietDepth();
  config.drift_mm = 30.0;
  config.drift_s = 200.0;
  EXPECT_NEAR(meanMm(config, 2.0F, 0.0), 30.0, 0.7);
  EXPECT_NEAR(meanMm(config, 2.0F, 200.0), 30.0 * std::exp(-1.0), 0.7);
  EXPECT_NEAR(meanMm(config, 2.0F, 3600.0), 0.0, 0.7);
  EXPECT_NEAR(meanMm(config, 4.0F, 0.0), 120.0, 2.5) << "with z^2";
}

TEST(SimulatorDistortion, TheWavesOfAColdCameraAreLarger) {
  DepthConfig config = quietDepth();
  config.distortion = 1.0;
  config.drift_percent = 50.0;
  const cv::Mat cold = errorMm(config, 3.0F, 0.0)(cv::Rect(100, 0, 540, 480));
  const cv::Mat warm = errorMm(config, 3.0F, 1e6)(cv::Rect(100, 0, 540, 480));
  EXPECT_NEAR(cv::norm(cold) / cv::norm(warm), 1.5, 0.03);
  config.drift_percent = 0.0;
  EXPECT_EQ(cv::norm(errorMm(config, 3.0F, 1e6), errorMm(config, 3.0F, 0.0), cv::NORM_INF), 0.0);
}

TEST(SimulatorDistortion, TheTrueFieldIsThatOfItsTimeWithTheBowlAndWithoutTheSteps) {
  DepthConfig config = quietDepth();
  config.distortion = 1.0;
  config.bowl_mm = 15.0;
  config.drift_mm = 20.0;
  const auto left = [&](const DepthConfig& camera, double time_s, double field_s) {
    const cv::Mat depth = sense(wall(2.5F), camera, 1U, time_s);
    const DepthField field = trueField(config, xtion(), field_s);
    cv::Mat corrected, off;
    DepthCorrection(field, depth.size()).apply(depth, 0.001, corrected);
    cv::absdiff(corrected, cv::Scalar(2500.0), off);
    off.setTo(0, depth == 0);
    double most = 0;
    cv::minMaxLoc(off, nullptr, &most);
    return most;
  };
  EXPECT_LT(left(config, 100.0, 100.0), 3.0);
  EXPECT_GT(left(config, 0.0, 600.0), 20.0) << "the field of a warm camera on a cold one";
  DepthConfig striped = config;
  striped.stripe_mm = 10.0;
  const double steps = left(striped, 100.0, 100.0);
  EXPECT_GT(steps, 6.0) << "what no smooth field has";
  EXPECT_LT(steps, 10.0 * 1.5625 + 3.0);
}

}  // namespace
}  // namespace pf::simulator

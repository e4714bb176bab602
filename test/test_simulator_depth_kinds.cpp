// SPDX-License-Identifier: BSD-3-Clause
// Time of flight and active stereo have the errors that the papers on them give.
#include <gtest/gtest.h>

#include <cmath>

#include "depth_wall.hpp"

namespace pf::simulator {
namespace {

DepthConfig kind(const char* name) {
  DepthConfig config;
  config.kind = name;
  config.distortion = 0.0;
  return config;
}
DepthConfig timeOfFlight() { return kind("time_of_flight"); }
DepthConfig activeStereo() {
  DepthConfig config = kind("active_stereo");
  config.baseline_m = 0.05;
  return config;
}

/// A thing 1.5 m away before a wall at 3 m, from column 300 to 399.
DepthView thing() {
  DepthView view = wall(3.0F);
  view.depth_m(cv::Rect(300, 0, 100, 480)) = 1.5F;
  return view;
}

struct Spread {
  double mean_mm = 0, sigma_mm = 0, filled = 0;
};
Spread spreadOf(const cv::Mat& depth, const cv::Rect& where = {100, 50, 500, 380}) {
  cv::Scalar mean, sigma;
  const cv::Mat part = depth(where);
  cv::meanStdDev(part, mean, sigma, part > 0);
  return {mean[0], sigma[0], cv::countNonZero(part) / static_cast<double>(part.total())};
}

TEST(SimulatorTimeOfFlight, DarkThingsAreOffByMoreThanBrightOnes) {
  DepthConfig config = timeOfFlight();
  config.tof_brightness_mm = 20.0;
  config.tof_wiggling_mm = 0.0;
  DepthView view = wall(1.5F);
  view.infrared(cv::Rect(0, 0, 320, 480)) = 0.1F;
  const cv::Mat depth = sense(view, config);
  const double dark = spreadOf(depth, {20, 20, 280, 440}).mean_mm - 1500.0;
  const double bright = spreadOf(depth, {340, 20, 280, 440}).mean_mm - 1500.0;
  EXPECT_GT(dark, bright + 5.0);
  EXPECT_LT(dark, 20.0);
  EXPECT_NEAR(bright, 20.0 * 0.05 / (0.05 + 1.0 / 2.25), 0.5);
  config.tof_brightness_mm = 0.0;
  EXPECT_NEAR(spreadOf(sense(view, config), {20, 20, 280, 440}).mean_mm, 1500.0, 0.5);
}

TEST(SimulatorTimeOfFlight, TheErrorWigglesWithTheDistance) {
  DepthConfig config = timeOfFlight();
  config.tof_brightness_mm = 0.0;
  config.tof_wiggling_mm = 6.0;
  double least = 1e9, most = -1e9;
  for (int i = 0; i <= 12; ++i) {
    const double z = 1.2 + 0.04 * i;
    const double off = spreadOf(sense(wall(static_cast<float>(z)), config)).mean_mm - 1000.0 * z;
    least = std::min(least, off);
    most = std::max(most, off);
    EXPECT_NEAR(off, 6.0 * std::sin(2.0 * M_PI * z / 0.468), 0.5) << z;
  }
  EXPECT_GT(most, 5.0);
  EXPECT_LT(least, -5.0);
}

TEST(SimulatorTimeOfFlight, NoiseGrowsWithTheDistanceAndAsLightIsLost) {
  const auto sigma = [](float z_m, float infrared) {
    DepthView view = wall(z_m);
    view.infrared = infrared;
    return spreadOf(sense(view, timeOfFlight())).sigma_mm;
  };
  EXPECT_NEAR(sigma(1.0F, 0.7F), 1.0, 0.15);
  EXPECT_GT(sigma(4.0F, 0.7F), 3.0);
  EXPECT_LT(sigma(4.0F, 0.7F), 8.0);
  EXPECT_GT(sigma(1.0F, 0.1F), 2.0 * sigma(1.0F, 0.7F));
  DepthView black = wall(3.0F);
  black.infrared = 0.01F;
  EXPECT_LT(spreadOf(sense(black, timeOfFlight())).filled, 0.05);
}

TEST(SimulatorTimeOfFlight, FlyingPixelsLieBetweenTheTwoSurfacesAndAtRimsAlone) {
  const cv::Mat depth = sense(thing(), timeOfFlight());
  int flying = 0;
  for (int row = 0; row < depth.rows; ++row) {
    for (int col = 0; col < depth.cols; ++col) {
      const int z = depth.at<std::uint16_t>(row, col);
      if (z == 0) continue;
      const bool at_rim = col == 299 || col == 300 || col == 399 || col == 400;
      EXPECT_GT(z, 1500 - 40);
      EXPECT_LT(z, 3000 + 40);
      const bool between = z > 1560 && z < 2940;
      EXPECT_TRUE(at_rim || !between) << col << ": " << z;
      flying += between ? 1 : 0;
    }
  }
  EXPECT_GT(flying, 4 * 480 / 4);
  const double beside = spreadOf(depth, {250, 0, 49, 480}).filled;
  EXPECT_GT(beside, 0.99) << "no shadow: light goes and comes the same way";
}

TEST(SimulatorActiveStereo, NoiseGrowsWithTheSquareOfTheDistance) {
  const auto sigma = [](float z_m) { return spreadOf(sense(wall(z_m), activeStereo())).sigma_mm; };
  for (const float z : {1.0F, 2.0F, 3.0F}) {
    const double steps_px = 1.0 / 32.0 / std::sqrt(12.0);
    const double expected = 1000.0 * z * z * std::hypot(0.08, steps_px) / (525 * 0.05);
    EXPECT_NEAR(sigma(z), expected, 0.12 * expected) << z;
  }
  EXPECT_NEAR(sigma(3.0F) / sigma(1.0F), 9.0, 1.2);
}

TEST(SimulatorActiveStereo, WithoutTextureAndPatternThereIsNoDepth) {
  DepthConfig config = activeStereo();
  DepthView view = wall(2.0F);
  EXPECT_GT(spreadOf(sense(view, config)).filled, 0.97) << "the pattern gives texture";
  config.stereo_projector = 0.0;
  EXPECT_LT(spreadOf(sense(view, config)).filled, 0.05);
  view.contrast = cv::Mat(view.depth_m.size(), CV_32FC1, cv::Scalar(0.15));
  EXPECT_GT(spreadOf(sense(view, config)).filled, 0.97) << "a wallpaper does too";
  EXPECT_LT(spreadOf(sense(wall(4.8F), activeStereo())).filled, 0.8) << "the pattern is faint";
}

TEST(SimulatorActiveStereo, OnTheLeftThingsHideTheWallAndThePictureEnds) {
  const cv::Mat depth = sense(thing(), activeStereo());
  const double hidden = 525 * 0.05 * (1.0 / 1.5 - 1.0 / 3.0);  // pixels
  const int from = 300 - static_cast<int>(hidden);
  EXPECT_LT(spreadOf(depth, {from + 2, 0, static_cast<int>(hidden) - 4, 480}).filled, 0.05);
  EXPECT_GT(spreadOf(depth, {from - 60, 0, 50, 480}).filled, 0.97);
  EXPECT_GT(spreadOf(depth, {410, 0, 50, 480}).filled, 0.97) << "not on the right";
  EXPECT_EQ(spreadOf(depth, {0, 0, 8, 480}).filled, 0.0) << "the other camera does not see it";
  EXPECT_GT(spreadOf(depth, {12, 0, 50, 480}).filled, 0.97);
}

TEST(SimulatorActiveStereo, RimsAreSmoothedAndHaveHoles) {
  DepthConfig config = activeStereo();
  const cv::Mat depth = sense(thing(), config);
  const Spread rim = spreadOf(depth, {398, 0, 4, 480}), inside = spreadOf(depth, {340, 0, 20, 480});
  EXPECT_LT(rim.filled, 0.9);
  EXPECT_GT(inside.filled, 0.97);
  EXPECT_GT(rim.mean_mm, 1600.0);
  EXPECT_LT(rim.mean_mm, 2900.0);
  int between = 0;
  for (int row = 0; row < 480; ++row) {
    const int z = depth.at<std::uint16_t>(row, 400);
    between += z > 1600 && z < 2800 ? 1 : 0;
  }
  EXPECT_GT(between, 200);
}

TEST(SimulatorDepthKinds, WithoutNoiseAllAreExact) {
  for (const char* name : {"structured_light", "time_of_flight", "active_stereo"}) {
    DepthConfig config = kind(name);
    config.noise = false;
    const Spread spread = spreadOf(sense(wall(2.5F), config));
    EXPECT_EQ(spread.mean_mm, 2500.0) << name;
    EXPECT_EQ(spread.sigma_mm, 0.0) << name;
    EXPECT_EQ(spread.filled, 1.0) << name;
  }
}

TEST(SimulatorDepthKinds, EachHasTheSmoothErrorsAndTheSameBytesAgain) {
  for (const char* name : {"structured_light", "time_of_flight", "active_stereo"}) {
    DepthConfig config = kind(name);
    config.drift_mm = 40.0;
    config.tof_wiggling_mm = config.tof_brightness_mm = 0.0;
    EXPECT_NEAR(spreadOf(sense(wall(2.0F), config)).mean_mm, 2040.0, 8.0) << name;
    EXPECT_EQ(cv::norm(sense(thing(), config), sense(thing(), config), cv::NORM_INF), 0.0) << name;
    EXPECT_GT(cv::norm(sense(thing(), config), sense(thing(), config, 2U), cv::NORM_INF), 0.0);
  }
}

}  // namespace
}  // namespace pf::simulator

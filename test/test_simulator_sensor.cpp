// SPDX-License-Identifier: BSD-3-Clause
// The errors of the cameras are those of the papers.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "depth_wall.hpp"
#include "posefusion/calibration/depth_correction.hpp"
#include "simulator/color_sensor.hpp"
#include "simulator/depth_distortion.hpp"
#include "simulator/depth_noise.hpp"

namespace pf::simulator {
namespace {

TEST(SimulatorDepth, SigmasAreThoseOfNguyen) {
  EXPECT_NEAR(axialSigmaM(0.4, 0.0), 0.0012, 1e-9);
  EXPECT_NEAR(axialSigmaM(2.0, 0.0), 0.0012 + 0.0019 * 1.6 * 1.6, 1e-9);
  EXPECT_GT(axialSigmaM(2.0, 1.4), axialSigmaM(2.0, 0.0));
  EXPECT_NEAR(lateralSigmaPx(0.0), 0.8, 1e-9);
}

TEST(SimulatorDepth, StepsGrowWithTheSquareOfTheDistance) {
  const DepthConfig config;
  EXPECT_NEAR(quantumM(4.0, config, 525) / quantumM(1.0, config, 525), 16.0, 1e-9);
  EXPECT_NEAR(quantumM(1.0, config, 525), 0.0032, 0.0005);  // about 3 mm at 1 m, as measured there
  DepthConfig quiet;
  quiet.axial = 0.0;
  quiet.distortion = 0.0;
  const cv::Mat depth = sense(wall(2.0F), quiet);
  double low, high;
  cv::minMaxLoc(depth, &low, &high, nullptr, nullptr, depth > 0);
  EXPECT_EQ(low, high);  // one step for a flat wall
  EXPECT_NEAR(low, 2000.0, 500.0 * quantumM(2.0, quiet, 525) + 1.0);
}

TEST(SimulatorDepth, TheTrueFieldUndoesTheDistortion) {
  DepthConfig config = quietDepth();
  config.distortion = 1.0;
  for (const int specimen : {1, 5}) {
    config.specimen = specimen;
    const DepthField field = trueField(config, xtion(), 0.0);
    for (const float z : {1.5F, 2.5F, 4.0F}) {
      const cv::Mat depth = sense(wall(z), config);
      cv::Mat corrected, off;
      DepthCorrection(field, depth.size()).apply(depth, 0.001, corrected);
      cv::absdiff(corrected, cv::Scalar(1000.0 * static_cast<double>(z)), off);
      off.setTo(0, depth == 0);
      double most = 0, before = 0;
      cv::minMaxLoc(off, nullptr, &most);
      cv::absdiff(depth, cv::Scalar(1000.0 * static_cast<double>(z)), off);
      off.setTo(0, depth == 0);
      cv::minMaxLoc(off, nullptr, &before);
      EXPECT_GT(before, 8.0) << z;
      EXPECT_LT(most, 3.0) << z << ", specimen " << specimen;
    }
  }
  config.noise = false;
  EXPECT_EQ(trueField(config, xtion(), 0.0).rms(), 0.0);
}

TEST(SimulatorDepth, NoiseOnAWallIsTheModels) {
  DepthConfig config;
  config.distortion = 0.0;
  for (const double z : {1.0, 2.0, 3.5}) {
    const cv::Mat depth = sense(wall(static_cast<float>(z)), config);
    cv::Scalar mean, deviation;
    cv::meanStdDev(depth, mean, deviation, depth > 0);
    const double quantum = quantumM(z, {}, 525);
    const double expected = std::hypot(axialSigmaM(z, 0.0), quantum / std::sqrt(12.0));
    EXPECT_NEAR(mean[0], 1000.0 * z, 250.0 * quantum + 1.0);
    EXPECT_NEAR(deviation[0], 1000.0 * expected, 150.0 * expected);
    EXPECT_GT(cv::countNonZero(depth), 0.95 * 640 * 480);
  }
}

TEST(SimulatorDepth, SystematicErrorsAreThoseOfTheCameraNotOfTheFrame) {
  const auto smooth = [](std::uint32_t key, int specimen) {
    DepthConfig config;
    config.specimen = specimen;
    cv::Mat depth, mean;
    sense(wall(2.0F), config, key).convertTo(depth, CV_32F);
    depth.setTo(2000.0F, depth == 0.0F);
    cv::resize(depth, mean, {8, 6}, 0, 0, cv::INTER_AREA);
    return mean;
  };
  const cv::Mat first = smooth(1U, 1), again = smooth(2U, 1), other = smooth(1U, 2);
  EXPECT_LT(cv::norm(first, again, cv::NORM_INF), 2.0);
  EXPECT_GT(cv::norm(first, other, cv::NORM_INF), 8.0);
  EXPECT_LT(cv::norm(first, cv::Mat(first.size(), CV_32F, cv::Scalar(2000)), cv::NORM_INF), 40.0);
}

TEST(SimulatorDepth, RangeDarkGrazingAndShinySurfacesHaveNoDepth) {
  EXPECT_EQ(cv::countNonZero(sense(wall(0.3F), {})), 0);
  EXPECT_EQ(cv::countNonZero(sense(wall(9.0F), {})), 0);
  EXPECT_LT(cv::countNonZero(sense(wall(2.0F, 0.05F), {})), 0.2 * 640 * 480);
  DepthView dark = wall(3.0F);
  dark.infrared = 0.02F;
  EXPECT_LT(cv::countNonZero(sense(dark, {})), 0.2 * 640 * 480);
  DepthView mirror = wall(2.0F);
  mirror.gloss = 0.9F;
  EXPECT_LT(cv::countNonZero(sense(mirror, {})), 0.4 * 640 * 480);
}

TEST(SimulatorDepth, ThingsCastAShadowOfTheProjectorOnTheirLeft) {
  DepthView view = wall(3.0F);
  view.depth_m(cv::Rect(300, 0, 100, 480)) = 1.0F;
  const cv::Mat depth = sense(view, {});
  const double width = 525 * 0.075 * (1.0 / 1.0 - 1.0 / 3.0);  // pixels
  const auto filled = [&](int x, int columns) {
    return cv::countNonZero(depth(cv::Rect(x, 0, columns, 480))) / (480.0 * columns);
  };
  EXPECT_LT(filled(300 - static_cast<int>(width) + 3, static_cast<int>(width) - 6), 0.1);
  EXPECT_GT(filled(200, 50), 0.95);
  EXPECT_GT(filled(420, 50), 0.95);
  EXPECT_GT(filled(320, 50), 0.95);
}

TEST(SimulatorDepth, WithoutNoiseDepthIsExact) {
  DepthConfig config;
  config.noise = false;
  const cv::Mat depth = sense(wall(1.2345F), config);
  EXPECT_EQ(cv::countNonZero(depth != 1235) * cv::countNonZero(depth != 1234), 0);
}

TEST(SimulatorDepth, MisregistrationMovesDepthAndMaskBesideTheColour) {
  DepthView view = wall(3.0F);
  view.depth_m(cv::Rect(300, 100, 100, 200)) = 1.5F;
  view.label(cv::Rect(300, 100, 100, 200)) = 2;
  DepthConfig config;
  config.noise = false;
  cv::Mat depth, mask, moved_depth, moved_mask;
  const PinholeCamera camera = xtion();
  senseDepth({view, camera, config, 1U}, depth, mask);
  config.misregistration_px = 3.0;
  senseDepth({view, camera, config, 1U}, moved_depth, moved_mask);
  const cv::Rect from(0, 0, 637, 480), to(3, 0, 637, 480);
  EXPECT_EQ(cv::norm(depth(from), moved_depth(to), cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(mask(from), moved_mask(to), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(depth, moved_depth, cv::NORM_INF), 1000.0);
}

TEST(SimulatorColor, JpegCostsDetailByItsQuality) {
  cv::Mat grey(96, 96, CV_32FC1), radiance;  // grey: JPEG halves the resolution of colours
  cv::randu(grey, 0.0, 0.5);
  cv::merge(std::vector<cv::Mat>(3, grey), radiance);
  const auto picture = [&](int quality) {
    ColorConfig config;
    config.noise = 0.0;
    config.jpeg_quality = quality;
    cv::Mat out;
    ColorSensor(config).expose(radiance, {16.0, 1.0}, 3U, out);
    return out;
  };
  const cv::Mat plain = picture(0);
  const double good = cv::norm(plain, picture(95), cv::NORM_L1) / (96.0 * 96.0 * 3.0);
  const double bad = cv::norm(plain, picture(20), cv::NORM_L1) / (96.0 * 96.0 * 3.0);
  EXPECT_GT(good, 0.0);
  EXPECT_GT(bad, 1.5 * good);
  EXPECT_LT(bad, 30.0);  // still the same picture
}

TEST(SimulatorColor, ExposureFollowsTheLightInSteps) {
  ColorConfig config;
  AutoExposure exposure(config);
  exposure.look(cv::Mat(48, 64, CV_32FC3, cv::Scalar::all(0.5)));
  const Exposure bright = exposure.current();
  const cv::Mat dark(48, 64, CV_32FC3, cv::Scalar::all(0.1));
  double before = bright.time_ms * bright.gain;
  for (int i = 0; i < 80; ++i) {
    exposure.look(dark);
    const double now = exposure.current().time_ms * exposure.current().gain;
    EXPECT_LE(now / before, 1.2);  // never more than a quarter of a stop at once
    EXPECT_GE(now, before);
    before = now;
  }
  EXPECT_NEAR(before / (bright.time_ms * bright.gain), 5.0, 1.0);
  EXPECT_LE(exposure.current().time_ms, config.max_exposure_ms);
}

TEST(SimulatorColor, GainRaisesTheNoise) {
  ColorConfig config;
  config.vignette = 0.0;
  ColorSensor sensor(config);
  const auto deviation = [&](double light, const Exposure& exposure) {
    cv::Mat picture;
    sensor.expose(cv::Mat(100, 100, CV_32FC3, cv::Scalar::all(light)), exposure, 3U, picture);
    cv::Scalar mean, sigma;
    cv::meanStdDev(picture, mean, sigma);
    EXPECT_NEAR(mean[1], 128.0, 30.0);
    return sigma[1];
  };
  const double low = deviation(0.12, {16.0, 1.0}), high = deviation(0.12 / 8, {16.0, 8.0});
  EXPECT_GT(low, 0.5);
  EXPECT_GT(high, 2.0 * low);
}

}  // namespace
}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "posefusion/blur/gate.hpp"

namespace pf {
namespace {

cv::Mat noiseImage() {
  cv::Mat image(120, 160, CV_8UC3);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(BlurScore, FallsWithMoreBlur) {
  const cv::Mat sharp = noiseImage();
  double previous = scoreBlur(sharp);
  for (const double sigma : {0.5, 1.0, 2.0, 4.0}) {
    cv::Mat picture;
    cv::GaussianBlur(sharp, picture, {}, sigma);
    const double score = scoreBlur(picture);
    EXPECT_LT(score, previous) << "sigma " << sigma;
    previous = score;
  }
}

TEST(BlurScore, IsTheVarianceOfTheLaplacian) {
  cv::Mat image(5, 5, CV_8UC3, cv::Scalar(0, 0, 0));
  image.at<cv::Vec3b>(2, 2) = {100, 100, 100};
  // Response: -400 at the centre and 100 at its four neighbours, mean 0.
  EXPECT_NEAR(scoreBlur(image), (400.0 * 400 + 4 * 100 * 100) / 25, 1e-6);
}

TEST(BlurScore, OfAFlatImageIsZero) {
  EXPECT_EQ(scoreBlur(cv::Mat(10, 10, CV_8UC3, cv::Scalar(9, 9, 9))), 0.0);
}

/// A scene with detail at all scales, as real ones have, and sensor noise.
class Camera {
 public:
  explicit Camera(double noise = 1.1) : noise_(noise), scene_(240, 600, CV_32FC1, cv::Scalar(120)) {
    cv::RNG random(3);
    for (int size = 2; size <= 64; size *= 2) {
      cv::Mat octave(240 / size + 2, 600 / size + 2, CV_32FC1), large;
      random.fill(octave, cv::RNG::NORMAL, 0.0, 12.0);
      cv::resize(octave, large, {}, size, size, cv::INTER_CUBIC);
      scene_ += large(cv::Rect(0, 0, 600, 240));
    }
  }

  void setContrast(double contrast) { contrast_ = contrast; }

  /// The next frame: the camera pans, and smears the picture by so many pixels to the side.
  cv::Mat shoot(int smear_px = 1) {
    position_ = (position_ + 7) % 200;
    cv::Mat smeared, noise(240, 320, CV_32FC1);
    cv::blur(scene_, smeared, {std::max(1, smear_px), 1});
    cv::Mat grey = contrast_ * smeared(cv::Rect(position_, 0, 320, 240)).clone();
    random_.fill(noise, cv::RNG::NORMAL, 0.0, noise_);
    return toColor(grey + noise);
  }

  /// A wall without texture that is lit unevenly.
  cv::Mat shootWall() {
    cv::Mat grey(240, 320, CV_32FC1), noise(240, 320, CV_32FC1);
    for (int col = 0; col < grey.cols; ++col) grey.col(col).setTo(100.0 + 0.1 * col);
    random_.fill(noise, cv::RNG::NORMAL, 0.0, noise_);
    return toColor(grey + noise);
  }

 private:
  static cv::Mat toColor(const cv::Mat& grey) {
    cv::Mat bytes, color;
    grey.convertTo(bytes, CV_8UC1);
    cv::cvtColor(bytes, color, cv::COLOR_GRAY2RGB);
    return color;
  }

  double noise_;
  double contrast_ = 1.0;
  int position_ = 0;
  cv::Mat scene_;
  cv::RNG random_{9};
};

constexpr std::int64_t kFrame_ns = 33'333'333;

/// A gate of a camera with 30 frames a second.
class Gate {
 public:
  explicit Gate(const BlurConfig& config = {}) : gate_(config) {}

  BlurScore judge(const Sharpness& sharpness) {
    return gate_.judge(sharpness, stamp_ns_ += kFrame_ns);
  }
  void reset() { gate_.reset(); }

 private:
  BlurGate gate_;
  std::int64_t stamp_ns_ = 1'000'000'000'000LL;
};

/// The decisions of the gate on so many frames of the camera.
template <typename Shoot>
std::vector<BlurScore> feed(Gate& gate, int frames, const Shoot& shoot) {
  std::vector<BlurScore> scores;
  for (int i = 0; i < frames; ++i) scores.push_back(gate.judge(measureSharpness(shoot(i))));
  return scores;
}

/// How many the gate called blurred.
int blurred(const std::vector<BlurScore>& scores) {
  return static_cast<int>(std::count_if(scores.begin(), scores.end(),
                                        [](const BlurScore& s) { return !s.sharp || s.forced; }));
}

TEST(Sharpness, FineDetailFallsWithMoreBlurNotWithLessContrast) {
  Camera camera(0.5);
  const cv::Mat sharp = camera.shoot();
  const double detail = measureSharpness(sharp).fine_detail;
  EXPECT_GT(detail, 0.1);
  for (const double contrast : {0.7, 0.5, 0.35}) {
    const cv::Mat faint = contrast * sharp;
    EXPECT_NEAR(measureSharpness(faint).fine_detail, detail, 0.1 * detail) << contrast;
  }
  double previous = detail;
  for (const double sigma_px : {1.0, 1.5, 2.0, 3.0}) {
    cv::Mat picture;
    cv::GaussianBlur(sharp, picture, {}, sigma_px);
    const double now = measureSharpness(picture).fine_detail;
    EXPECT_LT(now, 0.8 * previous) << sigma_px;
    previous = now;
  }
}

TEST(Sharpness, OfImagesThatShowNothing) {
  cv::Mat noise(48, 64, CV_8UC3);
  cv::RNG(1).fill(noise, cv::RNG::NORMAL, 100, 4);
  for (const cv::Mat& image : {cv::Mat(48, 64, CV_8UC3, cv::Scalar(9, 9, 9)), noise,
                               cv::Mat(1, 1, CV_8UC3, cv::Scalar(0, 0, 0))}) {
    const Sharpness sharpness = measureSharpness(image);
    EXPECT_TRUE(sharpness.dull) << image.size();
    EXPECT_EQ(sharpness.fine_detail, 0.0);
  }
}

TEST(BlurGate, PassesASceneThatStays) {
  Camera camera;
  Gate gate;
  EXPECT_EQ(blurred(feed(gate, 60, [&](int) { return camera.shoot(); })), 0);
}

TEST(BlurGate, DropsBurstsOfMotionBlur) {
  for (const int smear_px : {9, 14, 25}) {
    for (const int burst : {5, 15}) {
      Camera camera;
      Gate gate;
      feed(gate, 31, [&](int) { return camera.shoot(); });
      EXPECT_EQ(blurred(feed(gate, burst, [&](int) { return camera.shoot(smear_px); })), burst)
          << smear_px;
      EXPECT_EQ(blurred(feed(gate, 31, [&](int) { return camera.shoot(); })), 0) << smear_px;
    }
  }
}

TEST(BlurGate, DropsFramesOutOfFocus) {
  for (const double sigma_px : {2.0, 3.0, 5.0}) {
    Camera camera;
    Gate gate;
    feed(gate, 40, [&](int) { return camera.shoot(); });
    cv::Mat picture;
    cv::GaussianBlur(camera.shoot(), picture, {}, sigma_px);
    EXPECT_FALSE(gate.judge(measureSharpness(picture)).sharp) << sigma_px;
  }
}

TEST(BlurGate, HalvedContrastIsNoBlur) {
  Camera camera;
  Gate gate;
  feed(gate, 40, [&](int) { return camera.shoot(); });
  camera.setContrast(0.5);
  const auto scores = feed(gate, 60, [&](int) { return camera.shoot(); });
  EXPECT_EQ(blurred(scores), 0);
  // Blur is found in the fainter picture too.
  EXPECT_EQ(blurred(feed(gate, 10, [&](int) { return camera.shoot(14); })), 10);
}

TEST(BlurGate, ADullWallIsBackWithinASecond) {
  for (const double noise : {0.0, 1.0, 3.0}) {
    Camera camera(noise);
    Gate gate;
    feed(gate, 40, [&](int) { return camera.shoot(); });
    feed(gate, 30, [&](int) { return camera.shootWall(); });
    EXPECT_EQ(blurred(feed(gate, 60, [&](int) { return camera.shootWall(); })), 0) << noise;
    EXPECT_EQ(blurred(feed(gate, 60, [&](int) { return camera.shoot(); })), 0) << noise;
  }
}

/// A measurement of which only the fine detail matters.
Sharpness detail(double value) { return {1000.0 * value, value, false}; }

TEST(BlurGate, WhateverTheSceneBecomesItPassesWithinASecond) {
  Gate gate;
  for (int i = 0; i < 100; ++i) gate.judge(detail(1.0));
  int blurred = 0;
  for (int i = 0; i < 30; ++i) {
    const BlurScore score = gate.judge(detail(0.01));
    blurred += !score.sharp || score.forced;
  }
  EXPECT_LE(blurred, 16);  // until they are most of the last 30
  for (int i = 0; i < 100; ++i) {
    const BlurScore score = gate.judge(detail(0.01));
    EXPECT_TRUE(score.sharp && !score.forced) << i;
  }
}

TEST(BlurGate, FixedThresholdIsOnTheVarianceOfTheLaplacian) {
  BlurConfig config;
  config.threshold = 50;
  Gate gate(config);
  EXPECT_FALSE(gate.judge({49.0, 9.0, false}).sharp);
  const BlurScore score = gate.judge({50.0, 0.0, true});
  EXPECT_TRUE(score.sharp);
  EXPECT_EQ(score.measure, 50.0);
  EXPECT_EQ(score.threshold, 50.0);
}

TEST(BlurGate, AFrameThatPassesByForceIsMarked) {
  BlurConfig config;
  config.max_gap_s = 0.1;
  config.threshold = 50;  // for good: nothing but force lets these pass
  Gate gate(config);
  EXPECT_TRUE(gate.judge({60.0, 0.0, false}).sharp);
  for (int i = 1; i < 100; ++i) {
    const BlurScore score = gate.judge({1.0, 0.0, false});
    EXPECT_EQ(score.sharp, i % 3 == 0) << i;
    EXPECT_EQ(score.forced, i % 3 == 0) << i;
  }
  EXPECT_FALSE(gate.judge({60.0, 0.0, false}).forced);
}

TEST(BlurGate, ASlowCameraIsLeftAsShortATime) {
  BlurConfig config;
  config.max_gap_s = 0.1;
  config.threshold = 50;
  BlurGate gate(config);
  const Sharpness blur{1.0, 0.0, false};
  std::vector<bool> passed;
  for (int i = 0; i < 5; ++i) passed.push_back(gate.judge(blur, 2 * i * kFrame_ns).sharp);
  EXPECT_EQ(passed, (std::vector<bool>{false, false, true, false, true})) << "15 frames a second";
  // The clock jumps back: it goes on from there.
  passed.clear();
  for (int i = 0; i < 5; ++i) passed.push_back(gate.judge(blur, i * kFrame_ns).sharp);
  EXPECT_EQ(passed, (std::vector<bool>{false, false, false, true, false}));
}

TEST(BlurGate, DisabledPassesEverything) {
  BlurConfig config;
  config.enabled = false;
  Gate gate(config);
  EXPECT_TRUE(gate.judge(detail(1000)).sharp);
  EXPECT_TRUE(gate.judge(detail(0)).sharp);
}

TEST(BlurGate, ResetForgets) {
  Gate gate;
  gate.judge(detail(1.0));
  EXPECT_FALSE(gate.judge(detail(0.01)).sharp);
  gate.reset();
  EXPECT_TRUE(gate.judge(detail(0.01)).sharp);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

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
    cv::Mat blurred;
    cv::GaussianBlur(sharp, blurred, {}, sigma);
    const double score = scoreBlur(blurred);
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

TEST(BlurGate, AdaptiveThresholdFollowsTheScene) {
  BlurGate gate{BlurConfig{}};
  EXPECT_TRUE(gate.judge(100).sharp);
  EXPECT_TRUE(gate.judge(90).sharp);
  EXPECT_FALSE(gate.judge(20).sharp);
  EXPECT_TRUE(gate.judge(95).sharp);
}

TEST(BlurGate, FixedThresholdIsKept) {
  BlurConfig config;
  config.threshold = 50;
  BlurGate gate(config);
  EXPECT_FALSE(gate.judge(49).sharp);
  EXPECT_TRUE(gate.judge(50).sharp);
}

TEST(BlurGate, NeverDropsMoreInARowThanAllowed) {
  BlurConfig config;
  config.max_consecutive_drops = 3;
  BlurGate gate(config);
  EXPECT_TRUE(gate.judge(1000).sharp);
  int longest = 0, run = 0;
  for (int i = 0; i < 100; ++i) {
    run = gate.judge(1).sharp ? 0 : run + 1;
    longest = std::max(longest, run);
  }
  EXPECT_EQ(longest, 3);
  EXPECT_TRUE(gate.judge(1).sharp) << "the history has followed the duller scene";
}

TEST(BlurGate, DisabledPassesEverything) {
  BlurConfig config;
  config.enabled = false;
  BlurGate gate(config);
  EXPECT_TRUE(gate.judge(1000).sharp);
  EXPECT_TRUE(gate.judge(0).sharp);
}

TEST(BlurGate, ResetForgets) {
  BlurGate gate{BlurConfig{}};
  gate.judge(1000);
  EXPECT_FALSE(gate.judge(10).sharp);
  gate.reset();
  EXPECT_TRUE(gate.judge(10).sharp);
}

}  // namespace
}  // namespace pf

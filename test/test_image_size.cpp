// SPDX-License-Identifier: BSD-3-Clause
// The measured motion of the camera does not depend on how many pixels the pictures have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "posefusion/blur/sharpness.hpp"
#include "posefusion/slam/mapper.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

/// The last of some frames, as the chain sees it.
struct Seen {
  FrameStatus status;
  double error_m = 0;
};

/// The small room in pictures of the same view, `width` pixels wide, of a sensor that matches at
/// 640. Without flow the pose is that of the alignment alone.
Seen lastAt(int width, bool with_flow) {
  constexpr int kFrames = 4;
  const auto text = [](double value) { return std::to_string(value); };
  const SimulatedSequence room(
      "empty_box", kFrames,
      {"camera.width=" + std::to_string(width), "depth.disparity_steps=" + text(8.0 * 640 / width),
       "depth.lateral=" + text(width / 640.0)});
  Mapper mapper{Config{}};
  FlowTracker flow;
  Seen seen;
  for (int i = 0; i < kFrames; ++i) {
    const TrueFrame truth = room.frame(i);
    StaticFrame still;
    still.frame = truth.frame;
    if (with_flow) still.flow = flow.advance(truth.frame);
    seen.status = mapper.process(still);
    EXPECT_EQ(seen.status.outcome, FrameOutcome::fused) << width << ", frame " << i;
    seen.error_m =
        (seen.status.T_map_camera.translation() - truth.T_map_camera.translation()).norm();
  }
  return seen;
}

double sigmaOf(const Matrix6d& covariance, int first) {
  return std::sqrt(covariance.block<3, 3>(first, first).trace());
}

TEST(ImageSize, TheAlignmentIsTheSame) {
  const Seen usual = lastAt(640, false);
  for (const int width : {320, 1280}) {
    const Seen seen = lastAt(width, false);
    for (const int first : {0, 3}) {
      const double ratio =
          sigmaOf(seen.status.covariance, first) / sigmaOf(usual.status.covariance, first);
      EXPECT_NEAR(std::log(ratio), 0.0, std::log(1.35)) << width << " " << first;
    }
    EXPECT_EQ(seen.status.tracking.free_directions, usual.status.tracking.free_directions) << width;
    EXPECT_LT(seen.error_m, 0.01) << width;
  }
}

TEST(ImageSize, TheMotionOfCornersIsTheSameAsFarAsTheyHaveThePixels) {
  const Seen usual = lastAt(640, true);
  for (const int width : {320, 1280}) {
    const Seen seen = lastAt(width, true);
    for (const int first : {0, 3}) {
      const double ratio = sigmaOf(seen.status.motion.covariance, first) /
                           sigmaOf(usual.status.motion.covariance, first);
      // A corner is measured to a part of a pixel of the full picture, not better.
      EXPECT_LT(ratio, 1.25 * std::max(1.0, 640.0 / width)) << width << " " << first;
      EXPECT_GT(ratio, 0.8) << width << " " << first;
    }
    EXPECT_LT(seen.error_m, 0.01) << width;
  }
}

TEST(ImageSize, AWorkingPixelHasTheSameAngle) {
  const FrameConfig config;
  for (const int width : {320, 640, 1280, 1920}) {
    const double focal_px = 525.0 * width / 640;
    EXPECT_EQ(focal_px / shrinkFor(config, focal_px), 262.5) << width;
  }
  EXPECT_EQ(shrinkFor(config, 90.0), 1) << "it is not made larger";
  EXPECT_EQ(shrinkFor({0.3, 5.0, 3}, 525.0), 3) << "as it is set";
}

TEST(ImageSize, TheSameBlurLooksTheSameInLargerPictures) {
  cv::RNG random(5);
  cv::Mat scene(480, 640, CV_8UC1);
  random.fill(scene, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(scene, scene, {}, 3.0);
  cv::normalize(scene, scene, 20, 230, cv::NORM_MINMAX);
  for (const int smear_px : {1, 9}) {
    double detail[2];
    for (const int times : {1, 2}) {
      cv::Mat large, color;
      cv::resize(scene, large, {}, times, times, cv::INTER_CUBIC);
      cv::blur(large, large, {smear_px * times, 1});
      cv::cvtColor(large, color, cv::COLOR_GRAY2RGB);
      detail[times - 1] = measureSharpness(color).fine_detail;
    }
    EXPECT_NEAR(detail[1] / detail[0], 1.0, 0.15) << smear_px;
  }
}

}  // namespace
}  // namespace pf

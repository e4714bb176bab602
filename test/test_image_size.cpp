// SPDX-License-Identifier: BSD-3-Clause
// What is said of the camera's motion does not depend on how many pixels the pictures have.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

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
/// 640.
Seen lastAt(int width) {
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
    still.flow = flow.advance(truth.frame);
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

TEST(ImageSize, WhatIsKnownOfAPoseIsTheSame) {
  const Seen usual = lastAt(640);
  for (const int width : {320, 1280}) {
    const Seen seen = lastAt(width);
    const auto ratio = [&](const auto& covarianceOf, int first) {
      return sigmaOf(covarianceOf(seen.status), first) / sigmaOf(covarianceOf(usual.status), first);
    };
    const auto tracked = [](const FrameStatus& s) { return s.tracking.covariance; };
    const auto moved = [](const FrameStatus& s) { return s.motion.covariance; };
    for (const int first : {0, 3}) {
      EXPECT_NEAR(std::log(ratio(tracked, first)), 0.0, std::log(1.25)) << width << " " << first;
      EXPECT_NEAR(std::log(ratio(moved, first)), 0.0, std::log(1.25)) << width << " " << first;
    }
    EXPECT_EQ(seen.status.tracking.free_directions, usual.status.tracking.free_directions) << width;
    EXPECT_LT(seen.error_m, 0.01) << width;
  }
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/verdict.hpp"

#include <gtest/gtest.h>

namespace pf {
namespace {

constexpr int kPixels = 10000;

/// An alignment that looks right in every way, some way from the prediction.
class JudgeTest : public testing::Test {
 protected:
  JudgeTest() {
    frame_.depth_m = cv::Mat(100, 100, CV_32FC1, cv::Scalar(2.0));
    frame_.valid_pixels = kPixels;
    result_.converged = true;
    result_.covariance = independentCovariance(0.003, 0.003);
    prior_.covariance = independentCovariance(0.05, 0.05);
    prior_.is_measured = true;
    show(0.9);
  }

  /// The map shows so much of the frame, and nearly all of it agrees.
  void show(double part) {
    result_.candidates = static_cast<int>(part * kPixels);
    result_.inliers = static_cast<int>(0.95 * result_.candidates);
  }

  /// Metres from the prediction.
  Verdict verdict(double step_m) {
    result_.T_map_camera.translation().x() = step_m;
    return judge(frame_, result_, prior_, TrackingConfig{});
  }
  FrameOutcome judged(double step_m) { return verdict(step_m).outcome; }

  WorkingFrame frame_;
  TrackingResult result_;
  PosePrior prior_;
};

TEST_F(JudgeTest, WhatThePredictionAllowsIsAccepted) {
  EXPECT_EQ(judged(0.01), FrameOutcome::fused);
  EXPECT_EQ(judged(0.1), FrameOutcome::fused);
  EXPECT_EQ(judged(0.5), FrameOutcome::disagrees);
}

TEST_F(JudgeTest, AWeakAlignmentCannotLeaveItsPredictionFar) {
  // Images with half of the prediction's information move it by a part of its own error.
  EXPECT_EQ(judged(0.25), FrameOutcome::fused);
  result_.covariance = (1.0 / 1.5) * prior_.covariance;
  EXPECT_EQ(judged(0.25), FrameOutcome::disagrees);
  EXPECT_EQ(judged(0.1), FrameOutcome::fused);
  result_.covariance = prior_.covariance;
  EXPECT_EQ(judged(0.1), FrameOutcome::disagrees) << "nothing but the prediction";
}

TEST_F(JudgeTest, APredictionThatLostItsWeightMayBeLeftFarther) {
  result_.covariance = (1.0 / 1.5) * prior_.covariance;
  ASSERT_EQ(judged(0.25), FrameOutcome::disagrees);
  result_.prior_weight = 0.25;
  result_.covariance = (1.0 / 0.75) * prior_.covariance;
  EXPECT_EQ(judged(0.25), FrameOutcome::fused);
}

TEST_F(JudgeTest, WithoutCornersTheImagesHaveToProveAStep) {
  EXPECT_EQ(verdict(0.1).proof, Proof::none) << "corners agree";
  prior_.is_measured = false;
  EXPECT_EQ(verdict(0.1).proof, Proof::likely);
  EXPECT_EQ(verdict(0.01).proof, Proof::none) << "as it was going to";
  EXPECT_EQ(judged(0.5), FrameOutcome::jumped);
}

TEST_F(JudgeTest, AgainstAMeasuredMotionTheImagesHaveToBeSure) {
  prior_.covariance = independentCovariance(0.003, 0.003);
  EXPECT_EQ(judged(0.07), FrameOutcome::fused);
  EXPECT_EQ(verdict(0.07).proof, Proof::sure);
  EXPECT_EQ(judged(0.1), FrameOutcome::disagrees) << "no robot makes such a step";
}

TEST_F(JudgeTest, WithoutCornersNoDirectionMayBeFree) {
  result_.free_directions = 1;
  EXPECT_EQ(judged(0.01), FrameOutcome::fused);
  prior_.is_measured = false;
  EXPECT_EQ(judged(0.01), FrameOutcome::degenerate);
}

TEST_F(JudgeTest, AtTheRimOfTheMapNoDirectionMayBeFree) {
  // In a fall the last of the map leaves the view, and too few corners measure so fast a motion.
  show(0.25);
  EXPECT_EQ(judged(0.01), FrameOutcome::fused);
  result_.free_directions = 1;
  EXPECT_EQ(judged(0.01), FrameOutcome::degenerate);
}

TEST_F(JudgeTest, WhatIsSeenThroughIsNotThere) {
  result_.seen_through = result_.candidates / 2;
  EXPECT_EQ(judged(0.0), FrameOutcome::seen_through);
}

TEST_F(JudgeTest, TooLittleOfTheMapDecidesNothing) {
  show(0.01);
  EXPECT_EQ(judged(0.0), FrameOutcome::few_inliers);
  show(0.9);
  result_.inliers = result_.candidates / 10;
  EXPECT_EQ(judged(0.0), FrameOutcome::few_inliers);
  show(0.9);
  result_.converged = false;
  EXPECT_EQ(judged(0.0), FrameOutcome::not_converged);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/sparse_motion.hpp"

#include "sparse_motion_scene.hpp"

namespace pf {
namespace {

TEST_F(SparseMotionTest, IsExactForExactCorners) {
  addCorners(80, 0, 0.0);
  const SparseMotion motion = estimate();
  ASSERT_TRUE(motion.found);
  EXPECT_EQ(motion.inliers, 80);
  EXPECT_LT(error(motion).head<3>().norm(), 1e-3);
  EXPECT_LT(error(motion).tail<3>().norm(), 5e-4);
}

TEST_F(SparseMotionTest, LeavesOutWhatWalks) {
  addCorners(80, 40, 0.2);
  const SparseMotion motion = estimate();
  ASSERT_TRUE(motion.found);
  EXPECT_LE(motion.inliers, 85);
  EXPECT_LT(error(motion).head<3>().norm(), 5e-3);
  EXPECT_LT(error(motion).tail<3>().norm(), 2e-3);
}

TEST_F(SparseMotionTest, CornersWhosePlaceAPersonTouchesWeighLess) {
  addCorners(60, 0, 0.3);
  still_ = cv::Mat(60, 80, CV_8UC1, cv::Scalar(255));
  for (std::size_t i = 0; i < flow_.after.size(); i += 2) {
    flow_.after[i].x += 1.5F;  // dragged
    const cv::Point2f& at = flow_.before[i];
    still_.at<std::uint8_t>(static_cast<int>(at.y) / 8, static_cast<int>(at.x) / 8) = 0;
  }
  const SparseMotion weighed = estimate();
  still_.release();
  const SparseMotion all_alike = estimate();
  EXPECT_LT(2 * error(weighed).norm(), error(all_alike).norm());
}

TEST_F(SparseMotionTest, LeavesOutWhatStandsBeforeAStableSurfaceOfTheMap) {
  addCorners(30, 60, 0.1);  // more of the corners walk than not
  ModelView view;
  view.camera = camera_;
  view.depth_m = before_m_.clone();
  view.stable = cv::Mat(before_m_.size(), CV_8UC1, cv::Scalar(1));
  for (std::size_t i = 30; i < flow_.before.size();
       ++i) {  // the map has the wall behind them farther
    const cv::Rect around(cv::Point(flow_.before[i]) - cv::Point(1, 1), cv::Size(3, 3));
    view.depth_m(around).setTo(4.0F);
  }
  const SparseMotion motion = estimate(&view);
  ASSERT_TRUE(motion.found);
  EXPECT_LE(motion.matches, 35);
  EXPECT_LT(error(motion).head<3>().norm(), 5e-3);
}

TEST_F(SparseMotionTest, IsNotFoundWithFewCornersOrWithoutDepth) {
  addCorners(8, 0, 0.0);
  EXPECT_FALSE(estimate().found);
  addCorners(60, 0, 0.0);
  before_m_.setTo(0.0F);
  EXPECT_FALSE(estimate().found);
}

TEST_F(SparseMotionTest, CovarianceCoversTheError) {
  int covered = 0;
  for (int run = 0; run < 20; ++run) {
    flow_ = SparseFlow();
    addCorners(40 + run, 5, 0.3);
    const SparseMotion motion = estimate();
    ASSERT_TRUE(motion.found) << motion.inliers << " of " << motion.matches;
    const Vector6d e = error(motion);
    covered +=
        e.dot(motion.covariance.ldlt().solve(e)) < 20.0 ? 1 : 0;  // 6 degrees of freedom, 99.7 %
  }
  EXPECT_GE(covered, 18);
}

TEST_F(SparseMotionTest, OfFewCornersWhatIsExpectedLowersTheError) {
  double with = 0, without = 0;
  for (int run = 0; run < 20; ++run) {
    flow_ = SparseFlow();
    addCorners(16 + run, 0, 0.5);
    Vector6d off;
    off << 0.003, -0.002, 0.002, 0.001, 0.001, -0.002;
    expected_.reset();
    const SparseMotion alone = estimate();
    expect(run % 2 == 0 ? off : Vector6d(-off));
    const SparseMotion expected = estimate();
    ASSERT_TRUE(alone.found && expected.found);
    without += error(alone).squaredNorm();
    with += error(expected).squaredNorm();
  }
  EXPECT_LT(with, 0.7 * without);
}

TEST_F(SparseMotionTest, WhatIsExpectedIsNoMeasurement) {
  addCorners(40, 0, 0.0);
  const SparseMotion alone = estimate();
  expect(Vector6d::Zero());
  const SparseMotion expected = estimate();
  EXPECT_TRUE(expected.covariance.isApprox(alone.covariance, 0.01));
}

TEST_F(SparseMotionTest, ManyCornersOverruleWhatIsExpected) {
  addCorners(80, 0, 0.0);
  Vector6d blow;  // a robot hits the ground
  blow << 0.1, -0.05, 0.02, 0.05, 0.1, 0.02;
  expect(blow);
  const SparseMotion motion = estimate();
  EXPECT_EQ(motion.inliers, 80);
  EXPECT_LT(error(motion).head<3>().norm(), 2e-3);
}

TEST_F(SparseMotionTest, OfTwoMotionsTheExpectedOneIsFoundThoughMoreCornersShowTheOther) {
  addCorners(20, 24, 0.2);
  EXPECT_GT(error(estimate()).norm(), 0.01) << "else this tests nothing";
  Vector6d off;
  off << 0.003, -0.002, 0.002, 0.001, 0.001, -0.002;
  expect(off);
  EXPECT_LT(error(estimate()).norm(), 0.01);
}

}  // namespace
}  // namespace pf

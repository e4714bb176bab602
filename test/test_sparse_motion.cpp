// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/sparse_motion.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>

#include "small_camera.hpp"

namespace pf {
namespace {

/// A wall that leans, with corners on it, seen by two cameras; some corners belong to a walking
/// person.
class SparseMotionTest : public ::testing::Test {
 protected:
  static constexpr double kWall_m = 2.5;

  SparseMotionTest() {
    Vector6d twist;
    twist << 0.02, -0.01, 0.015, 0.01, 0.03, -0.005;
    T_before_after_ = expSe3(twist);
    before_m_ = depthFrom(Eigen::Isometry3d::Identity());
    after_m_ = depthFrom(T_before_after_);
    flow_.from_ns = 1;
    flow_.to_ns = 2;
  }

  /// Depth along a ray (camera at T) of the plane z = kWall_m + 0.3 x.
  static double hit(const Eigen::Isometry3d& T, const Eigen::Vector3d& ray) {
    const Eigen::Vector3d o = T.translation(), d = T.linear() * ray;
    return (kWall_m + 0.3 * o.x() - o.z()) / (d.z() - 0.3 * d.x());
  }

  cv::Mat depthFrom(const Eigen::Isometry3d& T) const {
    cv::Mat depth(camera_.height, camera_.width, CV_32FC1);
    for (int v = 0; v < depth.rows; ++v) {
      for (int u = 0; u < depth.cols; ++u) {
        depth.at<float>(v, u) = static_cast<float>(hit(T, camera_.unproject(u, v, 1.0)));
      }
    }
    return depth;
  }

  /// `count` corners of the wall, and `walking` that move by 6 pixels more than the wall does.
  void addCorners(int count, int walking, double noise_px) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> column(40, 600), row(40, 440);
    std::normal_distribution<double> noise(0.0, noise_px);
    for (int i = 0; i < count + walking; ++i) {
      const double u = column(random), v = row(random);
      const Eigen::Vector3d ray = camera_.unproject(u, v, 1.0);
      const Eigen::Vector3d point = ray * hit(Eigen::Isometry3d::Identity(), ray);
      const Eigen::Vector2d seen = camera_.project(T_before_after_.inverse() * point);
      const double walk = i < count ? 0.0 : 6.0;
      flow_.before.emplace_back(u, v);
      flow_.after.emplace_back(seen.x() + walk + noise(random), seen.y() + noise(random));
      flow_.ids.push_back(static_cast<std::uint32_t>(i));
    }
  }

  SparseMotion estimate(const ModelView* view = nullptr) const {
    FlowScene scene{before_m_, after_m_, view};
    scene.expected = expected_;
    scene.before_still = still_;
    return estimateMotion(flow_, scene, camera_);
  }

  /// It is expected to go on for 1/30 s as it does, but for this twist.
  void expect(const Vector6d& off) {
    expected_ = steadyStep(T_before_after_ * expSe3(off), 1.0 / 30, 1.0 / 30);
  }

  Vector6d error(const SparseMotion& motion) const {
    return logSe3(motion.T_before_after.inverse() * T_before_after_);
  }

  PinholeCamera camera_ = vga();
  Eigen::Isometry3d T_before_after_;
  cv::Mat before_m_, after_m_;
  cv::Mat still_;
  SparseFlow flow_;
  std::optional<ExpectedStep> expected_;
};

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

/// A person too near for the sensor's depth, before most of the wall; `twenty` corners of the wall
/// beside.
class NearPersonTest : public SparseMotionTest {
 protected:
  NearPersonTest() {
    addCorners(300, 0, 0.2);
    before_m_.colRange(kEdge_px, before_m_.cols).setTo(0);
    after_m_.colRange(kEdge_px, after_m_.cols).setTo(0);
    int beside = 0;
    SparseFlow kept = flow_;
    kept.before.clear(), kept.after.clear(), kept.ids.clear();
    for (std::size_t i = 0; i < flow_.before.size(); ++i) {
      const bool is_his = flow_.before[i].x > kEdge_px - kRim_px;
      if (is_his && flow_.before[i].x < kEdge_px + kRim_px) continue;
      if (!is_his && ++beside > 20) continue;
      kept.before.push_back(flow_.before[i]);
      kept.after.push_back(flow_.after[i] + (is_his ? cv::Point2f(14, 3) : cv::Point2f(0, 0)));
      kept.ids.push_back(flow_.ids[i]);
    }
    flow_ = kept;
  }
  SparseMotion estimate(const cv::Mat& still) const {
    return estimateMotion(
        flow_, {before_m_, after_m_, nullptr, nullptr, Eigen::Isometry3d::Identity(), still},
        camera_);
  }

  static constexpr int kEdge_px = 200, kRim_px = 12;
};

TEST_F(NearPersonTest, IsNotTakenForWhatIsFar) {
  cv::Mat still(480, 640, CV_8UC1, cv::Scalar(255));
  still.colRange(kEdge_px, still.cols).setTo(0);
  const SparseMotion motion = estimate(still);
  ASSERT_TRUE(motion.found);
  EXPECT_LT(error(motion).norm(), 0.02);
}

TEST_F(NearPersonTest, NorWhereTheMaskMissesItAndItsRimIsSeen) {
  // Narrower than where corners lie.
  for (const int from : {kEdge_px - 8, 624}) before_m_.colRange(from, from + 16).setTo(0.5);
  for (const int from : {0, 464}) before_m_(cv::Rect(kEdge_px, from, 424, 16)).setTo(0.5);
  const SparseMotion motion = estimate({});
  ASSERT_TRUE(motion.found);
  EXPECT_LT(error(motion).norm(), 0.02);
}

TEST_F(NearPersonTest, NorBeforeAMappedWallWithoutARim) {
  // From the person's edge on what is beside is the wall: only the map tells that it is not far.
  ModelView view;
  view.camera = camera_;
  view.depth_m = depthFrom(Eigen::Isometry3d::Identity());
  view.stable = cv::Mat(view.depth_m.size(), CV_8UC1, cv::Scalar(1));
  const SparseMotion motion = SparseMotionTest::estimate(&view);
  ASSERT_TRUE(motion.found);
  EXPECT_LE(motion.matches, 20);
  EXPECT_LT(error(motion).norm(), 0.02);
  EXPECT_GT(error(SparseMotionTest::estimate()).norm(), 0.02) << "else this tests nothing";
}

/// A part of the picture without depth that has most corners: a shiny panel on the wall, or a
/// window through which something infinitely far is seen. The camera goes fast.
class HoleTest : public SparseMotionTest, public testing::WithParamInterface<bool> {
 protected:
  HoleTest() {
    Vector6d twist;
    twist << 0.13, 0.04, 0.06, 0.06, 0.01, 0.15;
    T_before_after_ = expSe3(twist);
    after_m_ = depthFrom(T_before_after_);
    addCorners(400, 0, 0.2);
    const SparseFlow all = flow_;
    flow_.before.clear(), flow_.after.clear(), flow_.ids.clear();
    int beside = 0;
    for (std::size_t i = 0; i < all.before.size(); ++i) {
      const bool in_hole = all.before[i].x < kEdge_px;
      if (in_hole ? i % 4 != 0 : ++beside > 14) continue;
      flow_.before.push_back(all.before[i]);
      flow_.after.push_back(in_hole && GetParam() ? atInfinity(all.before[i]) : all.after[i]);
      flow_.ids.push_back(all.ids[i]);
    }
    before_m_.colRange(0, kEdge_px).setTo(0);
    after_m_.setTo(0);  // blurred: nothing is to be had of it
  }

  cv::Point2f atInfinity(const cv::Point2f& pixel) const {
    const Eigen::Vector3d ray = camera_.unproject(pixel.x, pixel.y, 1.0);
    const Eigen::Vector2d seen = camera_.project(T_before_after_.linear().transpose() * ray);
    return {static_cast<float>(seen.x()), static_cast<float>(seen.y())};
  }

  static constexpr int kEdge_px = 300;
};

TEST_P(HoleTest, DoesNotHoldBackAShift) {
  const SparseMotion motion = estimate();
  ASSERT_TRUE(motion.found) << motion.inliers << " of " << motion.matches;
  EXPECT_GT(motion.matches, 40) << "the hole's corners help to measure the turn";
  EXPECT_LT(error(motion).head<3>().norm(), 0.03);
  EXPECT_LT(error(motion).tail<3>().norm(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(PanelOrWindow, HoleTest, testing::Bool());

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
// Corners without depth: beyond the sensor's range, or on something too near for it, shiny or dark.
#include "sparse_motion_scene.hpp"

namespace pf {
namespace {

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

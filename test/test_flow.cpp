// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/frame/flow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace pf {
namespace {

/// Smooth noise, so that every place looks different, shifted by (dx, dy) pixels.
RgbdFrame frameOf(double dx, double dy, std::int64_t stamp_ns, const cv::Size& size = {640, 480}) {
  cv::Mat noise(600, 760, CV_8UC3);
  cv::RNG random(7);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {}, 4.0);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, dx - 40, 0, 1, dy - 40);
  RgbdFrame frame;
  frame.stamp_ns = stamp_ns;
  cv::warpAffine(noise, frame.color, shift, size);
  return frame;
}

TEST(Flow, FollowsAShiftToATenthOfAPixel) {
  FlowTracker tracker;
  EXPECT_TRUE(tracker.advance(frameOf(0, 0, 1)).empty());
  const SparseFlow& flow = tracker.advance(frameOf(7.5, -4.25, 2));
  EXPECT_EQ(flow.from_ns, 1);
  EXPECT_EQ(flow.to_ns, 2);
  ASSERT_GT(flow.before.size(), 100U);
  ASSERT_EQ(flow.before.size(), flow.after.size());
  std::size_t close = 0;  // corners cut by the border have no window of their own
  for (std::size_t i = 0; i < flow.before.size(); ++i) {
    const cv::Point2f error = flow.after[i] - flow.before[i] - cv::Point2f(7.5F, -4.25F);
    close += std::hypot(error.x, error.y) < 0.15 ? 1 : 0;
  }
  EXPECT_GE(close, flow.before.size() * 95 / 100);
  const FollowedPoints points = tracker.follow({{200, 150}, {430, 333}});
  ASSERT_EQ(points.found[0], 1);
  EXPECT_NEAR(points.after[1].x, 437.5, 0.3);
  EXPECT_NEAR(points.after[1].y, 328.75, 0.3);
}

TEST(Flow, CornersOfOnePosterDoNotKeepTheOtherCellsEmpty) {
  RgbdFrame frame = frameOf(0, 0, 1);
  cv::Mat faint;
  frame.color.convertTo(faint, CV_8UC3, 0.1, 100);  // everywhere but on the poster
  const cv::Rect poster(400, 100, 180, 160);
  frame.color(poster).copyTo(faint(poster));
  frame.color = faint;
  FlowTracker tracker;
  tracker.advance(frame);
  frame.stamp_ns = 2;
  const SparseFlow& flow = tracker.advance(frame);
  int outside = 0;
  for (const cv::Point2f& p : flow.before) outside += poster.contains(cv::Point(p)) ? 0 : 1;
  EXPECT_GT(outside, 30);
}

TEST(Flow, JoinedFlowsLeadOverTheFrameBetween) {
  FlowTracker tracker;
  tracker.advance(frameOf(0, 0, 1));
  const SparseFlow first = tracker.advance(frameOf(7.5, -4.25, 2));
  const SparseFlow second = tracker.advance(frameOf(12.25, 3.5, 3));
  const SparseFlow joined = join(first, second);
  EXPECT_EQ(joined.from_ns, 1);
  EXPECT_EQ(joined.to_ns, 3);
  ASSERT_EQ(joined.before.size(), joined.after.size());
  ASSERT_GT(joined.before.size(), first.before.size() / 2) << "most corners are found again";
  std::size_t close = 0;
  for (std::size_t i = 0; i < joined.before.size(); ++i) {
    const cv::Point2f error = joined.after[i] - joined.before[i] - cv::Point2f(12.25F, 3.5F);
    close += std::hypot(error.x, error.y) < 0.3 ? 1 : 0;
  }
  EXPECT_GE(close, joined.before.size() * 95 / 100);
}

TEST(Flow, FlowsWithAGapBetweenAreNotJoined) {
  const SparseFlow first{1, 2, {{10, 10}}, {{11, 10}}}, later{3, 4, {{11, 10}}, {{13, 10}}};
  EXPECT_EQ(join(first, later).from_ns, 3);
  EXPECT_EQ(join(first, later).before, later.before);
  const SparseFlow elsewhere{2, 3, {{50, 50}}, {{52, 50}}};
  EXPECT_TRUE(join(first, elsewhere).empty()) << "no corner is in both";
}

TEST(Flow, NothingIsFollowedOverAChangeOfSizeOrAReset) {
  FlowTracker tracker;
  tracker.advance(frameOf(0, 0, 1));
  EXPECT_TRUE(tracker.advance(frameOf(0, 0, 2, {320, 240})).empty());
  EXPECT_EQ(tracker.follow({{5, 5}}).found[0], 0)
      << "the pyramids are of one size, the frames are not";
  tracker.reset();
  EXPECT_TRUE(tracker.advance(frameOf(0, 0, 3)).empty());
}

}  // namespace
}  // namespace pf

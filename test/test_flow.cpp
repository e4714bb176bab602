// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/frame/flow.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace pf {
namespace {

/// Smooth noise, so that every place looks different, shifted by (dx, dy) pixels.
RgbdFrame frameOf(double dx, double dy, std::int64_t stamp_ns, const cv::Size& size = {640, 480}) {
  cv::Mat noise(800, 1000, CV_8UC3);
  cv::RNG random(7);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {}, 4.0);
  cv::normalize(noise, noise, 0, 255, cv::NORM_MINMAX);
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, dx - 200, 0, 1, dy - 150);
  RgbdFrame frame;
  frame.stamp_ns = stamp_ns;
  cv::warpAffine(noise, frame.color, shift, size);
  return frame;
}

/// Share of the corners that moved by `shift` to so many pixels; without those near the border,
/// whose surroundings are cut off.
double shareAt(const SparseFlow& flow, const cv::Point2f& shift, double tolerance_px) {
  const cv::Rect2f inside(32, 32, 576, 416);
  int all = 0, close = 0;
  for (std::size_t i = 0; i < flow.before.size(); ++i) {
    if (!inside.contains(flow.before[i]) || !inside.contains(flow.after[i])) continue;
    const cv::Point2f error = flow.after[i] - flow.before[i] - shift;
    ++all;
    close += std::hypot(error.x, error.y) < tolerance_px ? 1 : 0;
  }
  return static_cast<double>(close) / all;
}

TEST(Flow, FollowsAShiftToATenthOfAPixel) {
  FlowTracker tracker;
  EXPECT_TRUE(tracker.advance(frameOf(0, 0, 1)).empty());
  const SparseFlow& flow = tracker.advance(frameOf(7.5, -4.25, 2));
  EXPECT_EQ(flow.from_ns, 1);
  EXPECT_EQ(flow.to_ns, 2);
  ASSERT_GT(flow.before.size(), 100U);
  ASSERT_EQ(flow.before.size(), flow.after.size());
  EXPECT_GE(shareAt(flow, {7.5F, -4.25F}, 0.15), 0.95);
  const FollowedPoints points = tracker.images().follow({{200, 150}, {430, 333}});
  ASSERT_EQ(points.found[0], 1);
  EXPECT_NEAR(points.after[1].x, 437.5, 0.3);
  EXPECT_NEAR(points.after[1].y, 328.75, 0.3);
}

TEST(Flow, AGreyPictureIsFollowedAsItsColorsAre) {
  FlowTracker of_color, of_grey;
  for (const std::int64_t stamp_ns : {1, 2}) {
    RgbdFrame frame = frameOf(stamp_ns == 2 ? 7.5 : 0.0, 0, stamp_ns, {320, 240});
    cv::Mat grey;
    cv::cvtColor(frame.color, grey, cv::COLOR_RGB2GRAY);
    of_color.advance(frame);
    of_grey.advance(grey, stamp_ns);
  }
  const SparseFlow &color = of_color.images().corners(), &grey = of_grey.images().corners();
  ASSERT_GT(color.after.size(), 50U);
  EXPECT_EQ(color.after, grey.after);
  EXPECT_EQ(color.to_ns, grey.to_ns);
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

TEST(Flow, CornersKeepTheirNumberWhileTheyAreFollowed) {
  FlowTracker tracker;
  tracker.advance(frameOf(0, 0, 1));
  const SparseFlow first = tracker.advance(frameOf(3, 1, 2));
  const SparseFlow second = tracker.advance(frameOf(6, 2, 3));
  ASSERT_EQ(second.ids.size(), second.after.size());
  EXPECT_TRUE(std::is_sorted(second.ids.begin(), second.ids.end()));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < first.ids.size(); ++i) {
    const auto at = std::find(second.ids.begin(), second.ids.end(), first.ids[i]);
    if (at == second.ids.end()) continue;
    ++kept;
    const cv::Point2f gap = second.before[at - second.ids.begin()] - first.after[i];
    EXPECT_LT(std::hypot(gap.x, gap.y), 1e-3);
  }
  EXPECT_GT(kept, first.ids.size() * 8 / 10);
}

TEST(Flow, AChangeOfExposureIsNoMotion) {
  FlowTracker tracker;
  RgbdFrame frame = frameOf(0, 0, 1);
  tracker.advance(frame);
  RgbdFrame darker = frameOf(4, 0, 2);
  darker.color.convertTo(darker.color, CV_8UC3, 0.9, 25);
  const SparseFlow& flow = tracker.advance(darker);
  ASSERT_GT(flow.before.size(), 150U);
  EXPECT_GE(shareAt(flow, {4.0F, 0.0F}, 0.25), 0.9);
}

TEST(Flow, ReachesAsFarAsAFastTurnBetweenDroppedFrames) {
  FlowTracker tracker;
  tracker.advance(frameOf(0, 0, 1));
  const SparseFlow& flow = tracker.advance(frameOf(190, -20, 2));
  ASSERT_GT(flow.before.size(), 60U);
  EXPECT_GE(shareAt(flow, {190.0F, -20.0F}, 0.5), 0.9);
}

TEST(Flow, NothingIsFollowedOverAChangeOfSizeOrAReset) {
  FlowTracker tracker;
  tracker.advance(frameOf(0, 0, 1));
  EXPECT_TRUE(tracker.advance(frameOf(0, 0, 2, {320, 240})).empty());
  EXPECT_EQ(tracker.images().follow({{5, 5}}).found[0], 0)
      << "the pyramids are of one size, the frames are not";
  tracker.reset();
  EXPECT_TRUE(tracker.advance(frameOf(0, 0, 3)).empty());
}

}  // namespace
}  // namespace pf

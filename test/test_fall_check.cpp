// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/fall_check.hpp"

#include <gtest/gtest.h>

namespace pf {
namespace {

constexpr std::int64_t kUp_ns = 700'000'000;

/// Ten frames a second: upright, lost at 0.3 s, the map in view from 0.5 s on, up at 0.7 s, found
/// at 0.9 s.
std::vector<FallFrame> fallAndReturn() {
  std::vector<FallFrame> frames(12);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FallFrame& frame = frames[i];
    frame.stamp_ns = static_cast<std::int64_t>(i) * 100'000'000;
    frame.lost = i >= 3 && i < 9;
    frame.tracking = frame.has_pose = !frame.lost;
    frame.overlap = i < 3 || i >= 5 ? 0.9 : 0.1;
  }
  return frames;
}

TEST(FallCheck, MeasuresHowLongTheMapWasInView) {
  const FallReturn fall = checkReturn(fallAndReturn(), kUp_ns);
  EXPECT_TRUE(fall.was_lost);
  ASSERT_TRUE(fall.seconds());
  EXPECT_NEAR(*fall.seconds(), 0.4, 1e-9);
  EXPECT_EQ(fall.since_loss.frames, 7U) << "frames before the loss do not count";
  EXPECT_EQ(fall.since_loss.posed, 3U);
  EXPECT_EQ(fall.once_up.frames, 5U);
  EXPECT_EQ(fall.once_up.posed, 3U);
  EXPECT_EQ(fall.wrong, 0U);
}

TEST(FallCheck, ABlurredViewShowsNothing) {
  auto frames = fallAndReturn();
  frames[5].blurred = true;
  EXPECT_NEAR(*checkReturn(frames, kUp_ns).seconds(), 0.3, 1e-9);
}

TEST(FallCheck, ACameraFoundBySmallerViewsIsBackAtOnce) {
  auto frames = fallAndReturn();
  for (std::size_t i = 5; i < 11; ++i) frames[i].overlap = 0.7;
  EXPECT_EQ(checkReturn(frames, kUp_ns).seconds(), 0.0);
  frames[11].overlap = 0.7;
  EXPECT_FALSE(checkReturn(frames, kUp_ns).seconds()) << "the map was hardly in view";
}

TEST(FallCheck, ACameraThatStaysLostHasNoTime) {
  auto frames = fallAndReturn();
  frames.resize(9);
  const FallReturn fall = checkReturn(frames, kUp_ns);
  EXPECT_TRUE(fall.slowest.seen_ns);
  EXPECT_FALSE(fall.slowest.found_ns);
  EXPECT_FALSE(fall.seconds());
}

TEST(FallCheck, OfSeveralLossesTheSlowestCounts) {
  auto frames = fallAndReturn();
  frames[0].lost = true;  // at the start of a clip, before the fall
  frames[0].tracking = frames[0].has_pose = false;
  EXPECT_NEAR(*checkReturn(frames, kUp_ns).seconds(), 0.4, 1e-9);
  frames.resize(9);
  EXPECT_FALSE(checkReturn(frames, kUp_ns).seconds()) << "found once, and not after the fall";
  // A second loss in which the map is never in view does not count.
  frames = fallAndReturn();
  frames[11].lost = !(frames[11].tracking = frames[11].has_pose = false);
  frames[11].overlap = 0;
  EXPECT_NEAR(*checkReturn(frames, kUp_ns).seconds(), 0.4, 1e-9);
}

TEST(FallCheck, ACameraThatIsNotLostIsBackAtOnce) {
  auto frames = fallAndReturn();
  for (FallFrame& frame : frames) frame.lost = !(frame.tracking = frame.has_pose = true);
  const FallReturn fall = checkReturn(frames, kUp_ns);
  EXPECT_FALSE(fall.was_lost);
  EXPECT_EQ(fall.seconds(), 0.0);
  EXPECT_EQ(fall.since_loss.frames, 10U);
  EXPECT_EQ(fall.since_loss.posed, 10U);
}

TEST(FallCheck, CountsWrongPosesButNotWhereThereIsNone) {
  auto frames = fallAndReturn();
  frames[1].error_m = 0.2;
  frames[4].error_m = 0.2;  // has no pose
  frames[10].error_rad = 0.2;
  EXPECT_EQ(checkReturn(frames, kUp_ns).wrong, 2U);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/replay_progress.hpp"

#include <gtest/gtest.h>

namespace posefusion_ros {
namespace {

using std::chrono::seconds;

TEST(ReplayProgress, ReportsEveryFiveSecondsHowLongItTakes) {
  const ReplayProgress::Time begin = std::chrono::steady_clock::now();
  ReplayProgress progress(1000, begin);
  EXPECT_EQ(progress.after(50, begin + seconds(4)), "");
  EXPECT_EQ(progress.after(60, begin + seconds(6)),
            "60 of 1000 frames sent, 10.0 a second, 1:34 left");
  EXPECT_EQ(progress.after(100, begin + seconds(10)), "");
  EXPECT_EQ(progress.after(1001, begin + seconds(11)),
            "1001 of 1000 frames sent, 91.0 a second, 0:00 left");
}

TEST(ReplayProgress, IsSilentBeforeTheFirstFrame) {
  const ReplayProgress::Time begin = std::chrono::steady_clock::now();
  ReplayProgress progress(10, begin);
  EXPECT_EQ(progress.after(0, begin + seconds(60)), "");
}

}  // namespace
}  // namespace posefusion_ros

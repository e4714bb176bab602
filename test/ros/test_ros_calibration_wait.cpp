// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/calibration_wait.hpp"

#include <gtest/gtest.h>

#include "../temporary_folder.hpp"

namespace posefusion_ros {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class CalibrationWaitTest : public testing::Test {
 protected:
  /// The sentence, or the error, after a look so long after the question.
  std::string look(milliseconds after) {
    std::string said;
    const std::string error = pf::errorOf([&] { said = wait.look(now, start + after); });
    return error.empty() ? said : "error: " + error;
  }

  const CalibrationWait::Clock::time_point start = CalibrationWait::Clock::now();
  CalibrationProgress now{100, 3, 1, ""};
  CalibrationWait wait{now, start};
};

TEST_F(CalibrationWaitTest, WaitsForAStepAndReportsIt) {
  EXPECT_EQ(look(milliseconds(50)), "");
  now.frames = 130;
  EXPECT_EQ(look(seconds(1)), "");
  now.version = 2;
  now.said = "depth was off";
  EXPECT_EQ(look(seconds(2)), "depth was off");
}

TEST_F(CalibrationWaitTest, ADoubtIsNoSuccess) {
  now.said = "too few pairs";
  EXPECT_EQ(look(milliseconds(50)), "error: too few pairs");
}

TEST_F(CalibrationWaitTest, ReportsThatTheLoopCloserDidNotAnswer) {
  ++now.unanswered;
  EXPECT_NE(look(milliseconds(50)).find("error: the loop closer has left"), std::string::npos);
}

TEST_F(CalibrationWaitTest, WithoutFramesItEndsSoon) {
  EXPECT_EQ(look(seconds(4)), "");
  ++now.frames;
  EXPECT_EQ(look(seconds(8)), "") << "one has come";
  EXPECT_NE(look(seconds(14)).find("error: no frame has come for 5 s"), std::string::npos);
}

TEST_F(CalibrationWaitTest, WithFramesItEndsAfterItsLimit) {
  for (int s = 1; s <= 20; ++s) {
    ++now.frames;
    EXPECT_EQ(look(seconds(s)), "");
  }
  ++now.frames;
  EXPECT_NE(look(seconds(21)).find("error: the loop closer has not answered within 20 s"),
            std::string::npos);
}

}  // namespace
}  // namespace posefusion_ros

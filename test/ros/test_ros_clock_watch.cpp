// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/clock_watch.hpp"

#include <gtest/gtest.h>

namespace posefusion_ros {
namespace {

using std::chrono::seconds;

TEST(ClockDefect, IsSilentWhereStampsAreOfRosTime) {
  for (const double late_s : {-1.0, 0.0, 0.05, 30.0}) {
    for (const bool simulated : {false, true}) {
      EXPECT_EQ(clockDefect(ros::Time(1000), ros::Time(1000 + late_s), simulated), "") << late_s;
    }
  }
}

TEST(ClockDefect, NamesTheRemedyWhereABagIsPlayedWithoutItsTime) {
  const std::string said = clockDefect(ros::Time(1'305'031'102), ros::Time(1'795'455'175), false);
  EXPECT_NE(said.find("490424073 s behind ROS time"), std::string::npos) << said;
  EXPECT_NE(said.find("use_sim_time true"), std::string::npos) << said;
  EXPECT_NE(clockDefect(ros::Time(4'000'000'000), ros::Time(1), false).find("ahead of"),
            std::string::npos)
      << "and does not throw";
}

TEST(ClockDefect, NamesTheRemedyWhereTheClockIsMissing) {
  const std::string said = clockDefect(ros::Time(1'305'031'102), ros::Time(), true);
  EXPECT_NE(said.find("no /clock has come"), std::string::npos) << said;
  EXPECT_NE(said.find("--clock"), std::string::npos) << said;
}

TEST(GrowingPause, GrowsUpToFiveMinutes) {
  GrowingPause pause;
  const GrowingPause::Time begin = std::chrono::steady_clock::now();
  std::vector<int> said;
  for (int s = 0; s < 2000; ++s) {
    if (pause.isDue(begin + seconds(s), "no depth")) said.push_back(s);
  }
  EXPECT_EQ(said, (std::vector<int>{0, 5, 15, 35, 75, 155, 315, 615, 915, 1215, 1515, 1815}));
}

TEST(GrowingPause, WhatIsNewIsReportedAtOnce) {
  GrowingPause pause;
  const GrowingPause::Time now = std::chrono::steady_clock::now();
  EXPECT_TRUE(pause.isDue(now, "no depth"));
  EXPECT_FALSE(pause.isDue(now, "no depth"));
  EXPECT_TRUE(pause.isDue(now, "no colour"));
  EXPECT_FALSE(pause.isDue(now, ""));
  EXPECT_TRUE(pause.isDue(now, "no colour")) << "it was well in between";
}

}  // namespace
}  // namespace posefusion_ros

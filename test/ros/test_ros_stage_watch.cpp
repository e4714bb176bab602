// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/stage_watch.hpp"

#include <gtest/gtest.h>

#include "posefusion_ros/bags/messages.hpp"

namespace posefusion_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;
using std::chrono::milliseconds;

/// A watch, and a clock that the test sets.
class StageWatchTest : public testing::Test {
 protected:
  void pass(double latency_s = 0.05) { watch.passed(now, latency_s); }
  void giveUp(std::uint8_t outcome) { watch.givenUp(now, outcome); }
  void wait(int ms) { now += milliseconds(ms); }

  DiagnosticStatusWrapper report() {
    DiagnosticStatusWrapper out;
    watch.report(now, out);
    return out;
  }

  static std::string valueOf(const DiagnosticStatus& status, const std::string& key) {
    for (const auto& value : status.values) {
      if (value.key == key) return value.value;
    }
    return "none";
  }

  StageWatch::Time now;
  StageWatch watch{now};
};

TEST_F(StageWatchTest, RatesAreThoseSinceTheLastReport) {
  for (int i = 0; i < 30; ++i) pass();
  wait(1000);
  EXPECT_EQ(valueOf(report(), "rate (Hz)"), "30.0");
  for (int i = 0; i < 10; ++i) pass();
  wait(2000);
  const auto status = report();
  EXPECT_EQ(valueOf(status, "rate (Hz)"), "5.0");
  EXPECT_EQ(valueOf(status, "frames"), "40");
  EXPECT_EQ(status.level, DiagnosticStatus::OK);
}

TEST_F(StageWatchTest, SilenceIsAWarningUntilTheNextFrame) {
  wait(4900);
  EXPECT_EQ(report().level, DiagnosticStatus::OK);
  wait(200);
  const auto silent = report();
  EXPECT_EQ(silent.level, DiagnosticStatus::WARN);
  EXPECT_EQ(silent.message, "no frame for 5 s");
  pass();
  EXPECT_EQ(report().level, DiagnosticStatus::OK);
}

TEST_F(StageWatchTest, FramesGivenUpAreCountedByReasonAndManyAreAWarning) {
  for (int i = 0; i < 9; ++i) pass();
  giveUp(TrackingStatusMsg::DROPPED);
  EXPECT_EQ(report().level, DiagnosticStatus::OK) << "one in ten";
  for (int i = 0; i < 3; ++i) pass();
  giveUp(TrackingStatusMsg::DROPPED);
  giveUp(TrackingStatusMsg::NO_DEPTH);
  const auto status = report();
  EXPECT_EQ(status.level, DiagnosticStatus::WARN);
  EXPECT_EQ(status.message, "2 of 5 frames given up");
  EXPECT_EQ(valueOf(status, "given up: dropped"), "2");
  EXPECT_EQ(valueOf(status, "given up: no_depth"), "1");
  pass();
  EXPECT_EQ(report().level, DiagnosticStatus::OK) << "what was is over";
}

TEST_F(StageWatchTest, BlurIsNoWarning) {
  for (int i = 0; i < 5; ++i) giveUp(TrackingStatusMsg::BLURRED);
  const auto status = report();
  EXPECT_EQ(status.level, DiagnosticStatus::OK);
  EXPECT_EQ(valueOf(status, "given up: blurred"), "5");
}

TEST_F(StageWatchTest, LatencyIsThatOfTheLastFrames) {
  EXPECT_EQ(valueOf(report(), "after the stamp, median (ms)"), "none");
  for (int i = 0; i < 1000; ++i) pass(9.0);
  for (int i = 0; i < 300; ++i) pass(i < 290 ? 0.05 : 0.2);
  const auto status = report();
  EXPECT_EQ(valueOf(status, "after the stamp, median (ms)"), "50.0");
  EXPECT_EQ(valueOf(status, "after the stamp, 99 % (ms)"), "200.0");
}

TEST_F(StageWatchTest, WhatTheStageReportsIsShownUntilItsNextReport) {
  watch.set("people", "2");
  watch.tell(DiagnosticStatus::ERROR, "lost");
  pass();
  for (int i = 0; i < 2; ++i) {
    const auto status = report();
    EXPECT_EQ(status.level, DiagnosticStatus::ERROR);
    EXPECT_EQ(status.message, "lost");
    EXPECT_EQ(valueOf(status, "people"), "2");
  }
  watch.tell(DiagnosticStatus::OK, "");
  EXPECT_EQ(report().level, DiagnosticStatus::OK);
}

}  // namespace
}  // namespace posefusion_ros

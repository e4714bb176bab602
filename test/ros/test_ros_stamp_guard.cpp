// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/stamp_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace posefusion_ros {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Frames with stamps, by a clock that the test sets.
class StampGuardTest : public testing::Test {
 protected:
  /// Comes `after_s` after the one before.
  std::string defectAt(double stamp_s, double after_s = 0.067) {
    now += std::chrono::milliseconds(std::lround(1e3 * after_s));
    return guard.defectOf(std::llround(stamp_s * kSecond_ns), now);
  }
  StampGuard guard{1.0};
  StampGuard::Time now{};
};

TEST_F(StampGuardTest, RisingStampsPassHoweverLongTheGap) {
  EXPECT_EQ(defectAt(100), "");
  EXPECT_EQ(defectAt(100.067), "");
  EXPECT_EQ(defectAt(105.2, 5.133), "") << "the link was cut";
  EXPECT_EQ(defectAt(105.3, 0.001), "") << "what had waited comes at once";
  EXPECT_EQ(defectAt(105.4, 20), "") << "or late";
}

TEST_F(StampGuardTest, WhatIsNotLaterIsRefusedByItsValue) {
  EXPECT_EQ(defectAt(100), "");
  EXPECT_EQ(defectAt(100), "the stamp is that of the frame before");
  EXPECT_EQ(defectAt(99.5), "the stamp went back by 0.500 s");
  EXPECT_EQ(defectAt(0), "the stamp is 0");
  EXPECT_EQ(defectAt(100.1), "");
}

TEST_F(StampGuardTest, OneWrongStampCostsOneFrame) {
  EXPECT_EQ(defectAt(100), "");
  double right_s = 100;
  for (const double wrong_s : {5000.0, 3.0, 1e9}) {
    EXPECT_NE(defectAt(wrong_s).find("the stamp jumps"), std::string::npos) << wrong_s;
    EXPECT_EQ(defectAt(right_s += 0.133), "") << wrong_s;
  }
}

TEST_F(StampGuardTest, AClockThatWasPutRightIsFollowed) {
  for (const double to_s : {5000.0, 20.0}) {
    EXPECT_EQ(defectAt(to_s > 100 ? 100 : 5000.2), "");
    EXPECT_NE(defectAt(to_s).find("the stamp jumps"), std::string::npos);
    EXPECT_EQ(defectAt(to_s + 0.067), "");
    EXPECT_EQ(defectAt(to_s + 0.133), "");
  }
}

TEST(RateLimit, LetsTheRateOfACameraThatIsNotPunctualPass) {
  for (const double camera_hz : {15.0, 25.0, 30.0, 60.0, 90.0}) {
    RateLimit limit(15);
    int passed = 0;
    const int frames = static_cast<int>(20 * camera_hz);
    for (int i = 0; i < frames; ++i) {
      const double jitter_s = 0.002 * ((i * 7919) % 11 - 5) / 5.0;
      passed += limit.lets(std::llround((10 + i / camera_hz + jitter_s) * kSecond_ns)) ? 1 : 0;
    }
    EXPECT_GE(passed, 297) << camera_hz;
    EXPECT_LE(passed, 302) << camera_hz;
  }
}

TEST(RateLimit, GapsAndJumpsBeginAnew) {
  RateLimit limit(10);
  EXPECT_TRUE(limit.lets(5 * kSecond_ns));
  EXPECT_FALSE(limit.lets(5 * kSecond_ns + kSecond_ns / 20));
  EXPECT_TRUE(limit.lets(50 * kSecond_ns));
  EXPECT_FALSE(limit.lets(50 * kSecond_ns + kSecond_ns / 20)) << "no burst for the gap";
  EXPECT_TRUE(limit.lets(2 * kSecond_ns)) << "the clock was put back";
  EXPECT_FALSE(limit.lets(2 * kSecond_ns + kSecond_ns / 20));
}

}  // namespace
}  // namespace posefusion_ros

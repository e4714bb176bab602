// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/link_renewal.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace posefusion_ros {
namespace {

/// A connection, and a clock that the test sets.
class RenewalClockTest : public testing::Test {
 protected:
  void wait(double seconds) { now += std::chrono::milliseconds(std::lround(1e3 * seconds)); }
  RenewalClock clock{0.5};
  RenewalClock::Time now = RenewalClock::Time() + std::chrono::hours(1);
};

TEST_F(RenewalClockTest, NothingIsRenewedThatWasNeverHeardOrIsHeard) {
  wait(100);
  EXPECT_FALSE(clock.isToLook(now));
  clock.heard(now);
  wait(0.4);
  EXPECT_FALSE(clock.isToLook(now));
  wait(0.2);
  EXPECT_TRUE(clock.isToLook(now));
}

TEST_F(RenewalClockTest, AsSoonAsACutEndsItIsRenewedOnce) {
  clock.heard(now);
  wait(0.6);
  int looks = 0;
  for (int i = 0; i < 100; ++i, wait(0.05)) {
    if (!clock.isToLook(now)) continue;
    ++looks;
    EXPECT_FALSE(clock.looked(now, false)) << "the other machine is away";
  }
  EXPECT_GE(looks, 33) << "five seconds";
  EXPECT_LE(looks, 50);
  wait(0.15);
  ASSERT_TRUE(clock.isToLook(now));
  EXPECT_TRUE(clock.looked(now, true));
  wait(0.5);
  EXPECT_FALSE(clock.looked(now, true)) << "the new connection gets its time";
  clock.heard(now);
  EXPECT_FALSE(clock.isToLook(now));
}

TEST_F(RenewalClockTest, ASilentTopicIsRenewedEverMoreSeldom) {
  clock.heard(now);
  int renewals = 0;
  for (int i = 0; i < 1200; ++i, wait(0.05)) {  // a minute
    if (clock.isToLook(now) && clock.looked(now, true)) ++renewals;
  }
  EXPECT_GE(renewals, 6);
  EXPECT_LE(renewals, 9);
}

TEST_F(RenewalClockTest, ACutDuringThatPauseEndsThePause) {
  clock.heard(now);
  wait(1);
  EXPECT_TRUE(clock.looked(now, true));
  wait(1);
  EXPECT_FALSE(clock.looked(now, false));
  wait(0.2);
  EXPECT_TRUE(clock.looked(now, true));
}

}  // namespace
}  // namespace posefusion_ros

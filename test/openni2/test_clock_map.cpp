// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "posefusion_openni2/clock_map.hpp"

namespace pf::openni2 {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kEpoch = 1'700'000'000'000'000'000;

TEST(ClockMap, FiltersTheTransferJitterAwayAndFollowsTheDrift) {
  // The device's clock is 80 ppm fast; frames take 12 ms and up to 20 ms more.
  ClockMap map(ClockMap::Source::live);
  std::mt19937 random(3);
  std::exponential_distribution<double> jitter_ms(1 / 4.0);
  double worst_ms = 0.0;
  for (int i = 0; i < 30 * 600; ++i) {
    const std::int64_t taken = kEpoch + i * 33'333'333LL;
    const auto device_us = static_cast<std::int64_t>((i * 33'333.333) * (1 + 80e-6)) + 777;
    const double late_ms = 12.0 + std::min(20.0, jitter_ms(random));
    const std::int64_t stamp =
        map.toHostNs(device_us, taken + static_cast<std::int64_t>(late_ms * 1e6));
    if (i < 60) continue;
    worst_ms = std::max(worst_ms, std::abs(static_cast<double>(stamp - taken) * 1e-6 - 12.0));
  }
  EXPECT_LT(worst_ms, 1.0) << "of 20 ms of jitter";
}

TEST(ClockMap, GivesBothStreamsOfAMomentOneStamp) {
  ClockMap map(ClockMap::Source::live);
  for (int i = 0; i < 100; ++i) {
    const std::int64_t device_us = 33'333 * i, arrival = kEpoch + 33'333'000LL * i;
    const auto color = map.toHostNs(device_us, arrival + (i % 7) * kMs);
    EXPECT_EQ(map.toHostNs(device_us, arrival + 9 * kMs - (i % 5) * kMs), color) << i;
  }
}

TEST(ClockMap, NeverStampsAFrameAfterItsArrival) {
  ClockMap map(ClockMap::Source::live);
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t arrival = kEpoch + 33'333'000LL * i + static_cast<int>(random() % 30) * kMs;
    EXPECT_LE(map.toHostNs(33'333 * i, arrival), arrival);
    EXPECT_GE(map.lastDelayNs(), 0);
  }
}

TEST(ClockMap, StartsAnewWhenTheDevicesClockStepsBack) {
  ClockMap map(ClockMap::Source::live);
  map.toHostNs(90'000'000, kEpoch);
  EXPECT_EQ(map.toHostNs(1'000, kEpoch + 5 * kMs), kEpoch + 5 * kMs);
}

TEST(ClockMap, FollowsAJumpOfTheHostsClock) {
  ClockMap map(ClockMap::Source::live);
  std::int64_t jump = 0, stamp = 0;
  for (int i = 0; i < 100; ++i) {
    if (i == 50) jump = 3600 * 1000 * kMs;
    stamp = map.toHostNs(33'333 * i, kEpoch + 33'333'000LL * i + jump);
  }
  EXPECT_NEAR(static_cast<double>(stamp - (kEpoch + 33'333'000LL * 99 + jump)), 0.0, 1e6);
}

TEST(ClockMap, OneStallIsNoJump) {
  ClockMap map(ClockMap::Source::live);
  for (int i = 0; i < 30; ++i) map.toHostNs(33'333 * i, kEpoch + 33'333'000LL * i);
  const auto late = map.toHostNs(33'333 * 30, kEpoch + 33'333'000LL * 30 + 2000 * kMs);
  EXPECT_NEAR(static_cast<double>(late - (kEpoch + 33'333'000LL * 30)), 0.0, 1e6);
  EXPECT_NEAR(static_cast<double>(map.lastDelayNs()), 2e9, 1e6);
}

TEST(ClockMap, KeepsTheDistancesOfARecordingExactly) {
  ClockMap map(ClockMap::Source::recorded);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(map.toHostNs(33'333 * i, kEpoch + i * (i % 9) * kMs), kEpoch + 33'333'000LL * i);
  }
}

TEST(ClockMap, ARepeatedRecordingGoesOnWithoutAStepBack) {
  ClockMap map(ClockMap::Source::recorded);  // ten times as fast as recorded
  std::int64_t last = 0;
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 60; ++i) {
      const auto stamp = map.toHostNs(33'333 * i, kEpoch + (round * 60 + i) * 3 * kMs);
      EXPECT_GT(stamp, last);
      last = stamp;
    }
  }
}

TEST(ClockMap, TheLastFrameOfARoundMayComeAfterTheFirstOfTheNext) {
  ClockMap map(ClockMap::Source::recorded);
  for (int i = 0; i < 60; ++i) map.toHostNs(33'333 * i, kEpoch + 33'333'000LL * i);
  const std::int64_t end = kEpoch + 33'333'000LL * 60;
  const auto first = map.toHostNs(0, end);
  EXPECT_EQ(map.toHostNs(33'333 * 59, end + kMs), kEpoch + 33'333'000LL * 59);
  EXPECT_EQ(map.toHostNs(0, end + 2 * kMs), first);
  EXPECT_EQ(map.toHostNs(33'333, end + 40 * kMs), first + 33'333'000);
}

}  // namespace
}  // namespace pf::openni2

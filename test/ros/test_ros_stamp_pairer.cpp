// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "../../src/bags/stamp_pairer.hpp"

namespace posefusion_ros {
namespace {

struct Stamped {
  std::int64_t stamp_ns;
};

TEST(StampPairer, TakesTheNearerOfTwoNeighbours) {
  StampPairer<Stamped> pairer(20);
  for (const int s : {100, 133, 166}) pairer.addFirst({s});
  for (const int s : {95, 119, 131, 190}) pairer.addSecond({s});
  pairer.finish();
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  while (auto pair = pairer.next()) pairs.emplace_back(pair->first.stamp_ns, pair->second.stamp_ns);
  const std::vector<std::pair<std::int64_t, std::int64_t>> expected = {{100, 95}, {133, 131}};
  EXPECT_EQ(pairs, expected);
  EXPECT_EQ(pairer.unpairedFirst(), 1U);
  EXPECT_EQ(pairer.unpairedSecond(), 2U);
}

TEST(StampPairer, DoesNotDependOnHowTheStreamsInterleave) {
  cv::RNG random(5);
  std::vector<Stamped> first, second;
  for (int i = 0; i < 60; ++i) {
    if (random.uniform(0, 5) > 0) first.push_back({i * 33 + random.uniform(-3, 4)});
    if (random.uniform(0, 5) > 0) second.push_back({i * 33 + random.uniform(-3, 4)});
  }
  std::vector<std::pair<std::int64_t, std::int64_t>> expected;
  for (int run = 0; run < 20; ++run) {
    StampPairer<Stamped> pairer(20);
    std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
    const auto drain = [&] {
      while (auto p = pairer.next()) pairs.emplace_back(p->first.stamp_ns, p->second.stamp_ns);
    };
    std::size_t i = 0, j = 0;
    while (i < first.size() || j < second.size()) {
      const bool take_first = j == second.size() || (i < first.size() && random.uniform(0, 2) == 0);
      take_first ? pairer.addFirst(first[i++]) : pairer.addSecond(second[j++]);
      drain();
    }
    pairer.finish();
    drain();
    if (run == 0) expected = pairs;
    EXPECT_EQ(pairs, expected) << run;
    EXPECT_EQ(pairer.unpairedFirst() + pairs.size(), first.size());
    EXPECT_EQ(pairer.unpairedSecond() + pairs.size(), second.size());
  }
}

}  // namespace
}  // namespace posefusion_ros

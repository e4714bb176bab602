// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/stamps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pf {
namespace {

std::vector<std::int64_t> chosen(const std::vector<std::int64_t>& stamps) {
  const std::vector<bool> rising = risingStamps(stamps);
  std::vector<std::int64_t> out;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (rising[i]) out.push_back(stamps[i]);
  }
  return out;
}

using Stamps = std::vector<std::int64_t>;

TEST(RisingStamps, OneOfTheFutureOrOfThePastCostsItselfAlone) {
  EXPECT_EQ(chosen({}), Stamps());
  EXPECT_EQ(chosen({7}), Stamps({7}));
  EXPECT_EQ(chosen({1, 2, 900, 3, 4}), Stamps({1, 2, 3, 4}));
  EXPECT_EQ(chosen({1, 2, -900, 3, 4}), Stamps({1, 2, 3, 4}));
  EXPECT_EQ(chosen({900, 1, 2, 3}), Stamps({1, 2, 3}));
  EXPECT_EQ(chosen({1, 2, 900}), Stamps({1, 2, 900})) << "nothing contradicts it";
  EXPECT_EQ(chosen({1, 3, 2, 4}), Stamps({1, 3, 4})) << "of two alike the later one";
  EXPECT_EQ(chosen({5, 5, 5}), Stamps({5}));
}

TEST(RisingStamps, AreTheMostThatRise) {
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    Stamps stamps(1 + random() % 9);
    for (auto& stamp : stamps) stamp = random() % 7;
    // All subsets.
    std::size_t most = 0;
    for (unsigned subset = 0; subset < 1U << stamps.size(); ++subset) {
      Stamps taken;
      for (std::size_t k = 0; k < stamps.size(); ++k) {
        if (subset >> k & 1U) taken.push_back(stamps[k]);
      }
      const auto falls = std::adjacent_find(taken.begin(), taken.end(), std::greater_equal<>());
      if (falls == taken.end()) most = std::max(most, taken.size());
    }
    const Stamps out = chosen(stamps);
    EXPECT_EQ(out.size(), most);
    EXPECT_EQ(std::adjacent_find(out.begin(), out.end(), std::greater_equal<>()), out.end());
  }
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/stamps.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <tuple>

namespace posefusion {

std::vector<std::pair<std::size_t, std::size_t>> matchStamps(
    const std::vector<std::int64_t>& first, const std::vector<std::int64_t>& second,
    std::int64_t max_difference_ns) {
  std::vector<std::size_t> order(second.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return second[a] < second[b]; });

  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> candidates;
  for (std::size_t i = 0; i < first.size(); ++i) {
    auto at = std::partition_point(order.begin(), order.end(), [&](std::size_t j) {
      return second[j] <= first[i] - max_difference_ns;
    });
    for (; at != order.end() && second[*at] < first[i] + max_difference_ns; ++at) {
      candidates.emplace_back(std::llabs(second[*at] - first[i]), i, *at);
    }
  }
  std::sort(candidates.begin(), candidates.end());

  std::vector<bool> used_first(first.size()), used_second(second.size());
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [difference, i, j] : candidates) {
    if (used_first[i] || used_second[j]) continue;
    used_first[i] = used_second[j] = true;
    pairs.emplace_back(i, j);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace posefusion

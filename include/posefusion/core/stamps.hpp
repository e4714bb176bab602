// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pf {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Decimal seconds ("1341845820.819654") to nanoseconds, exactly. Throws InputError.
std::int64_t parseStamp(const std::string& seconds);

/// Nanoseconds as decimal seconds with six decimals, nine where six would lose something.
std::string formatStamp(std::int64_t stamp_ns);

inline double secondsBetween(std::int64_t from_ns, std::int64_t to_ns) {
  return 1e-9 * static_cast<double>(to_ns - from_ns);
}

/// Pairs two lists of stamps as the TUM benchmark does: of all pairs less than `max_difference_ns`
/// apart the closest is taken first, and each stamp is used once. Indices into `first` and
/// `second`, ordered by `first`. The lists need no order.
std::vector<std::pair<std::size_t, std::size_t>> matchStamps(
    const std::vector<std::int64_t>& first, const std::vector<std::int64_t>& second,
    std::int64_t max_difference_ns);

/// Which stamps of a recording to believe: the most that rise from each to the next, so that one of
/// the future costs itself alone, not all that come after it. Of two that exclude each other alike
/// the later stamp is believed.
std::vector<bool> risingStamps(const std::vector<std::int64_t>& stamps_ns);

}  // namespace pf

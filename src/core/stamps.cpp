// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/stamps.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iomanip>
#include <limits>
#include <numeric>
#include <sstream>
#include <tuple>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

constexpr int kStampDigits = 9;  // nanoseconds

/// A decimal number as its digits and the place of its point: "12.5e1" is 125 with the point
/// after 3.
struct Decimal {
  bool negative = false;
  std::string digits;
  long point = 0;
};

[[noreturn]] void failStamp(const std::string& text) {
  throw InputError("'" + text + "' is no stamp, expected decimal seconds");
}

Decimal parseDecimal(const std::string& text) {
  Decimal decimal;
  std::size_t i = 0;
  if (i < text.size() && (text[i] == '-' || text[i] == '+')) decimal.negative = text[i++] == '-';
  bool past_point = false;
  for (; i < text.size() && (std::isdigit(static_cast<unsigned char>(text[i])) || text[i] == '.');
       ++i) {
    if (text[i] == '.') {
      if (past_point) failStamp(text);
      past_point = true;
      continue;
    }
    decimal.digits += text[i];
    if (!past_point) ++decimal.point;
  }
  if (decimal.digits.empty()) failStamp(text);
  if (i == text.size()) return decimal;
  if (text[i] != 'e' && text[i] != 'E') failStamp(text);
  const std::string exponent = text.substr(i + 1);
  std::size_t used = 0;
  int power = 0;
  try {
    power = std::stoi(exponent, &used);
  } catch (const std::exception&) {
    failStamp(text);
  }
  if (used != exponent.size() || std::abs(power) > 30) failStamp(text);
  decimal.point += power;
  return decimal;
}

}  // namespace

std::int64_t parseStamp(const std::string& seconds) {
  const Decimal decimal = parseDecimal(seconds);
  const long count = decimal.point + kStampDigits;  // digits that make up the nanoseconds
  std::int64_t value = 0;
  for (long i = 0; i < count; ++i) {
    const int digit = i < static_cast<long>(decimal.digits.size())
                          ? decimal.digits[static_cast<std::size_t>(i)] - '0'
                          : 0;
    if (value > (std::numeric_limits<std::int64_t>::max() - digit) / 10) failStamp(seconds);
    value = 10 * value + digit;
  }
  // Digits beyond a nanosecond are rounded.
  if (count >= 0 && count < static_cast<long>(decimal.digits.size()) &&
      decimal.digits[static_cast<std::size_t>(count)] >= '5') {
    ++value;
  }
  return decimal.negative ? -value : value;
}

std::string formatStamp(std::int64_t stamp_ns) {
  const std::int64_t second = 1'000'000'000;
  const std::int64_t size = std::abs(stamp_ns);
  const bool micro = size % 1000 == 0;
  std::ostringstream text;
  text << (stamp_ns < 0 ? "-" : "") << size / second << '.' << std::setfill('0')
       << std::setw(micro ? 6 : 9) << (micro ? size % second / 1000 : size % second);
  return text.str();
}

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

std::vector<bool> risingStamps(const std::vector<std::int64_t>& stamps_ns) {
  // Longest increasing subsequence by patience sorting (Fredman 1975), from the end, where a chain
  // falls: ends[k] is the best end of a chain of k + 1 stamps, the greatest one.
  std::vector<std::size_t> ends;
  std::vector<std::size_t> after(stamps_ns.size());
  for (std::size_t i = stamps_ns.size(); i-- > 0;) {
    const auto place =
        std::lower_bound(ends.begin(), ends.end(), stamps_ns[i],
                         [&](std::size_t e, std::int64_t stamp) { return stamps_ns[e] > stamp; });
    after[i] = place == ends.begin() ? i : *(place - 1);
    if (place == ends.end()) {
      ends.push_back(i);
    } else {
      *place = i;
    }
  }
  std::vector<bool> rising(stamps_ns.size(), false);
  if (ends.empty()) return rising;
  for (std::size_t i = ends.back();; i = after[i]) {
    rising[i] = true;
    if (after[i] == i) break;
  }
  return rising;
}

}  // namespace pf

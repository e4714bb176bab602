// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "posefusion/config/field_text.hpp"

namespace pf {

/// Reads the whole of `text` into `value`. Returns what was expected instead; empty: it is read.
std::string readValue(const std::string& text, std::string& value);
std::string readValue(const std::string& text, bool& value);
std::string readValue(const std::string& text, double& value);

template <class T>
std::enable_if_t<std::is_integral_v<T>, std::string> readValue(const std::string& text, T& value) {
  const char* const end = text.data() + text.size();
  T number = 0;
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) {
    using Limits = std::numeric_limits<T>;
    return "a whole number, " + std::to_string(Limits::min()) + " to " +
           std::to_string(Limits::max());
  }
  value = number;
  return {};
}

template <class T>
std::string readValue(const std::string& text, std::optional<T>& value) {
  return readValue(text, value.emplace());
}

/// One value more.
template <class T>
std::string readValue(const std::string& text, std::vector<T>& values) {
  return readValue(text, values.emplace_back());
}

/// A value as it is typed; empty where there is none.
template <class T>
std::string showValue(const T& value) {
  if constexpr (std::is_same_v<T, std::string>) {
    return value;
  } else if constexpr (std::is_same_v<T, double>) {
    return numberText(value);
  } else if constexpr (std::is_arithmetic_v<T>) {
    return std::to_string(value);
  } else {
    return {};
  }
}

/// What the text of a value must be before it is read.
struct ValueCheck {
  std::string expected;                       ///< for the user; empty: nothing in particular
  std::function<bool(std::string&)> accepts;  ///< may replace the text
};

/// A number from `least` to `most`; whole where these are.
template <class T>
ValueCheck range(T least, T most) {
  const std::string kind = std::is_integral_v<T> ? "a whole number, " : "a number, ";
  return {kind + showValue(least) + " to " + showValue(most), [least, most](std::string& text) {
            T value{};
            return readValue(text, value).empty() && value >= least && value <= most;
          }};
}

ValueCheck positive();
ValueCheck nonNegative();
ValueCheck oneOf(const std::vector<std::string>& words);

}  // namespace pf

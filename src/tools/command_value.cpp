// SPDX-License-Identifier: BSD-3-Clause
#include "command_value.hpp"

#include <algorithm>
#include <boost/lexical_cast/try_lexical_convert.hpp>
#include <cmath>

namespace pf {

std::string readValue(const std::string& text, std::string& value) {
  value = text;
  return {};
}

std::string readValue(const std::string& text, bool& value) {
  const bool is_true = text == "true" || text == "1";
  if (!is_true && text != "false" && text != "0") return "true or false";
  value = is_true;
  return {};
}

std::string readValue(const std::string& text, double& value) {
  double number = 0;  // std::from_chars of GCC 10 reads whole numbers only
  if (!boost::conversion::try_lexical_convert(text, number) || !std::isfinite(number)) {
    return "a number";
  }
  value = number;
  return {};
}

ValueCheck positive() {
  return {"a number above 0", [](std::string& text) {
            double value = 0;
            return readValue(text, value).empty() && value > 0;
          }};
}

ValueCheck nonNegative() {
  return {"a number, 0 or more", [](std::string& text) {
            double value = 0;
            return readValue(text, value).empty() && value >= 0;
          }};
}

ValueCheck oneOf(const std::vector<std::string>& words) {
  std::string expected = "one of ";
  for (const std::string& word : words) {
    expected += (&word == words.data() ? "" : ", ") + word;
  }
  return {expected, [words](std::string& text) {
            return std::find(words.begin(), words.end(), text) != words.end();
          }};
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace pf {

/// What the user gave cannot be used: a file, a topic, a parameter. The message names it, its value
/// and what was expected. Tools print it and exit with 1; nodelets count it and go on.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws InputError unless it holds: `what` is `value`, and what was expected.
inline void require(bool holds, const char* what, double value, const char* expected) {
  if (holds) return;
  throw InputError(std::string(what) + " is " + std::to_string(value) + ", expected " + expected);
}

}  // namespace pf

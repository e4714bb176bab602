// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <sstream>
#include <string>

#include "posefusion/core/error.hpp"

namespace pf {

/// A finite decimal number that is all of the text. Throws InputError.
inline double parseNumber(const std::string& text) {
  std::istringstream in(text);
  double value = 0;
  if (!(in >> value) || !in.eof() || !std::isfinite(value)) {
    throw InputError("'" + text + "' is no number");
  }
  return value;
}

}  // namespace pf

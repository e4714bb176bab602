// SPDX-License-Identifier: BSD-3-Clause
#include "base64.hpp"

#include <cstdint>
#include <ostream>
#include <string>

namespace pf {
namespace {

constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

void writeBase64(std::ostream& out, const void* data, std::size_t bytes) {
  const auto* in = static_cast<const std::uint8_t*>(data);
  std::string text;
  text.reserve(base64Length(bytes));
  for (std::size_t i = 0; i < bytes; i += 3) {
    const std::size_t here = bytes - i < 3 ? bytes - i : 3;
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (k < here ? in[i + k] : std::uint32_t{0});
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= here ? kDigits[word >> (18 - 6 * k) & 63] : '=';
    }
  }
  out << text;
}

}  // namespace pf

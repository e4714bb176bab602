// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <iosfwd>

namespace pf {

/// How many characters writeBase64() makes of so many bytes.
inline std::size_t base64Length(std::size_t bytes) { return (bytes + 2) / 3 * 4; }

/// Writes bytes as text (RFC 4648, with padding, without line breaks).
void writeBase64(std::ostream& out, const void* data, std::size_t bytes);

}  // namespace pf

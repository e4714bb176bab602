// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pf {

/// A file of src/io/page, as it was when the library was built. Throws std::out_of_range where
/// there is none of that name.
const std::string& pagePart(const std::string& name);

}  // namespace pf

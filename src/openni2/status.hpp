// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include <string>

namespace pf::openni2 {

/// What OpenNI2 says of the last error of this thread, on one line.
std::string lastError();

/// Throws InputError "<what>: <last error>" unless the status is OK.
void check(openni::Status status, const std::string& what);

}  // namespace pf::openni2

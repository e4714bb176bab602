// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace pf {

/// A file or folder of the test data: below POSEFUSION_TEST_DATA, or ../shared/data.
inline std::string testData(const std::string& name) {
  const char* folder = std::getenv("POSEFUSION_TEST_DATA");
  return std::string(folder != nullptr ? folder : "../shared/data") + "/" + name;
}

}  // namespace pf

/// Skips the test where `path` does not exist, and says so.
#define POSEFUSION_REQUIRE_DATA(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "skipped: no test data at " << (path)

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/disk_reserve.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace pf {
namespace {

constexpr std::int64_t kShareOfFree = 8;

}  // namespace

DiskReserve::DiskReserve(const std::string& path, std::int64_t bytes) : path_(path) {
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  std::error_code error;
  const auto space = std::filesystem::space(std::filesystem::path(path).parent_path(), error);
  const auto free = error ? 0 : static_cast<std::int64_t>(space.available);
  // Not posix_fallocate(): where room cannot be reserved it writes all of it.
  const bool reserved =
      fd >= 0 && free > 0 && fallocate(fd, 0, 0, std::min(bytes, free / kShareOfFree)) == 0;
  if (fd >= 0) close(fd);
  if (!reserved) release();
}

void DiskReserve::release() {
  if (!path_.empty()) std::remove(std::exchange(path_, "").c_str());
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace pf {

/// Room on the disk that is kept free for what has to be written at the end of a run, when the disk
/// may be full: a file of zeros that release() removes.
class DiskReserve {
 public:
  /// As much as `bytes`, but no more than an eighth of what is free; none where the file system
  /// cannot reserve room.
  DiskReserve(const std::string& path, std::int64_t bytes);
  ~DiskReserve() { release(); }
  DiskReserve(const DiskReserve&) = delete;
  DiskReserve& operator=(const DiskReserve&) = delete;

  void release();

 private:
  std::string path_;  ///< empty: released
};

}  // namespace pf

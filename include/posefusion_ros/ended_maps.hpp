// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "posefusion/io/run_folder.hpp"

namespace posefusion_ros {

/// The folders of maps that were ended and saved without a request: the oldest
/// go when there are too many. Only files go that are as they were written here, so that other
/// files, and maps that a later run has extended, stay.
class EndedMaps {
 public:
  /// The newest. `names`: the files that were written, as far as they are there.
  void add(const pf::RunFolder& folder, const std::vector<std::string>& names);

  /// Removes the oldest until `most` are left, but none that has the file `in_use` (real path).
  void keep(std::size_t most, const std::string& in_use);

 private:
  struct File {
    std::string path;
    ino_t inode;
    off_t size;
    std::int64_t changed_ns;
  };
  struct Ended {
    pf::RunFolder folder;
    std::vector<File> files;
  };
  static void remove(const Ended& ended);

  std::deque<Ended> ended_;  // oldest first
};

/// The path without links, where the file is there; the path itself otherwise.
std::string realPath(const std::string& path);

}  // namespace posefusion_ros

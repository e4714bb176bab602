// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace pf {

/// Now, in local time, as folders are named: "2026-05-01_14-03-59".
std::string dateAndTime();

/// Makes the link `latest` beside a folder lead to it. Something of that name that is no link
/// stays.
void linkLatest(const std::filesystem::path& folder);

/// A folder of its own for the results of one run, below one that the user named:
/// `<parent>/<dateAndTime()>`, with `_2`, `_3` where
/// another run has begun in that second. So no run writes over another's results. Not thread safe.
class RunFolder {
 public:
  /// Makes the folder. Throws InputError naming it when that fails, or when nothing can be written
  /// into it (a trial file is written).
  explicit RunFolder(const std::string& parent);

  /// Whole path.
  std::string path() const { return path_.string(); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

  void makeLatest() const { linkLatest(path_); }

  /// Removes the folder where it is empty, and with it the parent where this run has made it.
  void removeIfEmpty() const;

  /// Says so where less than `least_mb` megabytes are free; empty otherwise.
  std::string lowSpace(double least_mb = 1000) const;

 private:
  std::filesystem::path parent_, path_;
  bool made_parent_ = false;
};

}  // namespace pf

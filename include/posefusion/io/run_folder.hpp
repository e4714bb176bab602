// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace pf {

/// A folder of its own for the results of one run, below one that the user named:
/// `<parent>/<year>-<month>-<day>_<hour>-<minute>-<second>`, in local time, with `_2`, `_3` where
/// another run has begun in that second. So no run writes over another's results, and two that run
/// at once never share one. Not thread safe.
class RunFolder {
 public:
  enum class Name {
    whole,   ///< at once
    partial  ///< with `.partial` at its end until finish()
  };

  /// Makes the folder; `kind` comes behind its date. Throws InputError naming it when that fails,
  /// or when nothing can be written into it (a trial file is written).
  explicit RunFolder(const std::string& parent, Name name = Name::whole,
                     const std::string& kind = "");

  /// All results are in it: gives a partial folder its whole name, in one step. Throws InputError
  /// naming the folder.
  void finish();

  /// Whole path.
  std::string path() const { return path_.string(); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }

  /// Makes the link `<parent>/latest` lead here. Something of that name that is no link stays.
  void makeLatest() const;

  /// Removes the folder with all that is in it, and the parent where this run has made it and there
  /// is nothing else.
  void discard() const;

  /// Removes the folder where it is empty, and with it the parent where this run has made it.
  void removeIfEmpty() const;

  /// Says so where less than `least_mb` megabytes are free; empty otherwise.
  std::string lowSpace(double least_mb = 1000) const;

 private:
  std::filesystem::path parent_, path_;
  bool made_parent_ = false;
};

/// Where the results of a run lie that a user names: below a folder of runs the newest (`latest`),
/// otherwise the path itself.
std::string newestRun(const std::string& path);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace pf {

/// A folder of results that is there whole or not at all, below one that the user named: its files
/// are written into `<parent>/<name>.part`, which finish() renames to `<parent>/<name>`, with `_2`,
/// `_3` where that is there already. So it takes the place of nothing. Not thread safe.
class CompleteFolder {
 public:
  /// Makes the folder that files are written into. Throws InputError naming it.
  CompleteFolder(const std::string& parent, const std::string& name);
  /// Without finish(): removes what is in it, and the parent where this has made it.
  ~CompleteFolder();
  CompleteFolder(const CompleteFolder&) = delete;
  CompleteFolder& operator=(const CompleteFolder&) = delete;

  /// Whole path to write a file at.
  std::string file(const std::string& name) const { return (temporary_ / name).string(); }

  /// The files are written. Returns the whole path of the folder. Throws InputError naming it.
  std::string finish();

 private:
  std::filesystem::path path_, temporary_;
  bool made_parent_ = false, is_finished_ = false;
};

}  // namespace pf

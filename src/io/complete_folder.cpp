// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/complete_folder.hpp"

#include <system_error>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

}  // namespace

CompleteFolder::CompleteFolder(const std::string& parent, const std::string& name) {
  const fs::path folder = fs::absolute(parent);
  made_parent_ = !fs::exists(fs::symlink_status(folder));
  makeFolder(folder.string());
  for (int i = 1;; ++i) {
    path_ = folder / (i == 1 ? name : name + "_" + std::to_string(i));
    temporary_ = path_.string() + ".part";
    std::error_code error;
    const bool made = fs::create_directory(temporary_, error);
    if (error) throw InputError(path_.string() + ": the folder cannot be made: " + error.message());
    if (!made) continue;  // somebody else writes there
    // Only who has made the one for writing may make the other: nobody comes in between.
    if (!fs::exists(fs::symlink_status(path_))) return;
    fs::remove(temporary_, error);
  }
}

CompleteFolder::~CompleteFolder() {
  if (is_finished_) return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
  if (made_parent_) fs::remove(path_.parent_path(), ignored);  // where nothing else is in it
}

std::string CompleteFolder::finish() {
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) throw InputError(path_.string() + ": cannot be written: " + error.message());
  is_finished_ = true;
  return path_.string();
}

}  // namespace pf

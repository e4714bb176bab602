// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/run_folder.hpp"

#include <unistd.h>

#include <ctime>
#include <system_error>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

constexpr char kLatest[] = "latest";

/// Makes a folder that was not there. Two processes never get the same one.
fs::path makeNewFolder(const fs::path& parent, const std::string& name) {
  for (int i = 1;; ++i) {
    const fs::path path = parent / (i == 1 ? name : name + "_" + std::to_string(i));
    std::error_code error;
    if (fs::create_directory(path, error)) return path;
    if (error) throw InputError(path.string() + ": the folder cannot be made: " + error.message());
  }
}

}  // namespace

std::string dateAndTime() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d_%H-%M-%S", &local);
  return text;
}

void linkLatest(const fs::path& folder) {
  const fs::path link = folder.parent_path() / kLatest;
  std::error_code ignored;
  const fs::file_status there = fs::symlink_status(link, ignored);
  if (fs::exists(there) && !fs::is_symlink(there)) return;
  // Renamed into place, so that there is a link at any time.
  const fs::path fresh = folder.parent_path() / (kLatest + (".part" + std::to_string(getpid())));
  fs::remove(fresh, ignored);
  fs::create_directory_symlink(folder.filename(), fresh, ignored);
  fs::rename(fresh, link, ignored);
}

RunFolder::RunFolder(const std::string& parent) : parent_(fs::absolute(parent)) {
  made_parent_ = !fs::exists(fs::symlink_status(parent_));
  makeFolder(parent_.string());
  path_ = makeNewFolder(parent_, dateAndTime());
  AtomicFile(file("trial")).stream() << "written to see that it can be\n";
}

void RunFolder::removeIfEmpty() const {
  std::error_code ignored;
  if (fs::remove(path_, ignored) && made_parent_) fs::remove(parent_, ignored);
}

std::string RunFolder::lowSpace(double least_mb) const {
  std::error_code error;
  const fs::space_info space = fs::space(path_, error);
  const double free_mb = 1e-6 * static_cast<double>(space.available);
  if (error || free_mb >= least_mb) return {};
  return path_.string() + ": only " + std::to_string(static_cast<long>(free_mb)) +
         " MB are free on the disk";
}

}  // namespace pf

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

std::string dateAndTime() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d_%H-%M-%S", &local);
  return text;
}

constexpr char kPartial[] = ".partial";

/// The name, or name_2, name_3, ...
std::string numbered(const std::string& name, int i) {
  return i == 1 ? name : name + "_" + std::to_string(i);
}

/// Makes a folder that was not there. Two processes never get the same one.
fs::path makeNewFolder(const fs::path& parent, const std::string& name, const std::string& end) {
  for (int i = 1;; ++i) {
    const fs::path whole = parent / numbered(name, i), path = whole.string() + end;
    if (fs::exists(whole)) continue;
    std::error_code error;
    if (fs::create_directory(path, error)) return path;
    if (error) throw InputError(path.string() + ": the folder cannot be made: " + error.message());
  }
}

}  // namespace

RunFolder::RunFolder(const std::string& parent, Name name, const std::string& kind)
    : parent_(fs::absolute(parent)) {
  made_parent_ = !fs::exists(fs::symlink_status(parent_));
  makeFolder(parent_.string());
  path_ = makeNewFolder(parent_, dateAndTime() + kind, name == Name::partial ? kPartial : "");
  AtomicFile(file("trial")).stream() << "written to see that it can be\n";
}

void RunFolder::finish() {
  if (path_.extension() != kPartial) return;
  const std::string name = path_.stem().string();
  for (int i = 1;; ++i) {
    const fs::path whole = parent_ / numbered(name, i);
    if (fs::exists(fs::symlink_status(whole))) continue;
    std::error_code error;
    fs::rename(path_, whole, error);  // does not replace a folder that holds something
    if (error == std::errc::directory_not_empty || error == std::errc::file_exists) continue;
    if (error) {
      throw InputError(path_.string() + ": cannot be renamed to " + whole.string() + ": " +
                       error.message());
    }
    path_ = whole;
    return;
  }
}

void RunFolder::makeLatest() const {
  const fs::path link = parent_ / kLatest;
  std::error_code ignored;
  const fs::file_status there = fs::symlink_status(link, ignored);
  if (fs::exists(there) && !fs::is_symlink(there)) return;
  // Renamed into place, so that there is a link at any time.
  const fs::path fresh = parent_ / (kLatest + (".part" + std::to_string(getpid())));
  fs::remove(fresh, ignored);
  fs::create_directory_symlink(path_.filename(), fresh, ignored);
  fs::rename(fresh, link, ignored);
}

void RunFolder::discard() const {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (made_parent_) fs::remove(parent_, ignored);
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

std::string newestRun(const std::string& path) {
  const fs::path latest = fs::path(path) / kLatest;
  std::error_code ignored;
  return fs::is_directory(latest, ignored) ? latest.string() : path;
}

}  // namespace pf

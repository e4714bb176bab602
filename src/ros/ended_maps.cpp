// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/ended_maps.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

namespace posefusion_ros {
namespace {

std::optional<struct stat> look(const std::string& path) {
  struct stat now {};
  if (lstat(path.c_str(), &now) != 0 || !S_ISREG(now.st_mode)) return std::nullopt;
  return now;
}

std::int64_t changedNs(const struct stat& file) {
  return std::int64_t{file.st_mtim.tv_sec} * 1000000000 + file.st_mtim.tv_nsec;
}

}  // namespace

std::string realPath(const std::string& path) {
  std::error_code error;
  const auto real = std::filesystem::canonical(path, error);
  return error ? path : real.string();
}

void EndedMaps::add(const pf::RunFolder& folder, const std::vector<std::string>& names) {
  Ended ended{folder, {}};
  for (const std::string& name : names) {
    const std::string path = folder.file(name);
    const auto file = look(path);
    if (file) ended.files.push_back({path, file->st_ino, file->st_size, changedNs(*file)});
  }
  ended_.push_back(std::move(ended));
}

void EndedMaps::keep(std::size_t most, const std::string& in_use) {
  for (auto oldest = ended_.begin(); ended_.size() > most && oldest != ended_.end();) {
    const auto& files = oldest->files;
    const auto isUsed = [&](const File& file) { return realPath(file.path) == in_use; };
    if (std::any_of(files.begin(), files.end(), isUsed)) {
      ++oldest;
    } else {
      remove(*oldest);
      oldest = ended_.erase(oldest);
    }
  }
}

/// Where a file is not as it was left, none goes: they belong together.
void EndedMaps::remove(const Ended& ended) {
  const auto isAsWritten = [](const File& file) {
    const auto now = look(file.path);
    return !now || (now->st_ino == file.inode && now->st_size == file.size &&
                    changedNs(*now) == file.changed_ns);
  };
  if (!std::all_of(ended.files.begin(), ended.files.end(), isAsWritten)) return;
  std::error_code ignored;
  for (const File& file : ended.files) std::filesystem::remove(file.path, ignored);
  ended.folder.removeIfEmpty();
}

}  // namespace posefusion_ros

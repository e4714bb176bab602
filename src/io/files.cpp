// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

std::string reason() { return errno != 0 ? std::strerror(errno) : "unknown reason"; }

/// Waits until a file, or the names in a folder, are on the disk. False with errno set.
bool sync(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  // Some file systems cannot do it: there the rename alone has to do.
  const bool done = fsync(fd) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int error = errno;
  close(fd);
  errno = error;
  return done;
}

std::string folderOf(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path)
    // The process in the name keeps two runs into one folder from mixing their bytes.
    : path_(path), temporary_(path + ".part" + std::to_string(getpid())) {
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) throw InputError(path_ + ": cannot be written: " + reason());
}

AtomicFile::~AtomicFile() {
  if (temporary_.empty()) return;
  stream_.close();
  std::remove(temporary_.c_str());
}

void AtomicFile::commit(Until until) {
  errno = 0;
  if (!stream_.flush()) {  // or a write before failed, whose reason is not known here
    throw InputError(path_ + ": cannot be written: " + (errno != 0 ? reason() : "disk full?"));
  }
  stream_.close();
  // Bytes before name: a name written first may belong to an empty file after a power cut.
  if (!stream_ || (until == Until::disk && !sync(temporary_))) {
    throw InputError(path_ + ": cannot be written: " + reason());
  }
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    throw InputError(path_ + ": cannot be replaced: " + reason());
  }
  temporary_.clear();
  if (until == Until::disk && !sync(folderOf(path_))) {
    throw InputError(path_ + ": may not be on the disk: " + reason());
  }
}

std::string readFile(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(path + ": is a folder, expected a file");
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened: " + reason());
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string endingOf(const std::string& path) {
  return std::filesystem::path(path).extension().string();
}

void requireEnding(const std::string& path, const std::vector<std::string>& endings) {
  const std::string ending = endingOf(path);
  if (std::find(endings.begin(), endings.end(), ending) != endings.end()) return;
  std::string expected = endings.front();
  for (std::size_t i = 1; i < endings.size(); ++i) {
    expected += (i + 1 < endings.size() ? ", " : " or ") + endings[i];
  }
  throw InputError(path + ": ends in '" + ending + "', expected " + expected);
}

void makeFolder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw InputError(path + ": the folder cannot be made: " + error.message());
  if (!std::filesystem::is_directory(path)) throw InputError(path + ": is no folder");
  if (access(path.c_str(), W_OK | X_OK) != 0) {
    throw InputError(path + ": the folder cannot be written into: " + reason());
  }
}

}  // namespace pf

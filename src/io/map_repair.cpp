// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/map_repair.hpp"

#include <unistd.h>

#include <filesystem>

#include "map_salvage.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

/// A copy of a damaged file, and of its log where that is its own, which goes away again: reading
/// it changes nothing of the user's.
class WorkingCopy {
 public:
  WorkingCopy(const std::string& damaged, const std::string& path) : path_(path) {
    const SqliteFiles files = lookAtFiles(damaged);
    copy(damaged, path_);
    if (!files.is_closed && files.has_log) copy(logOf(damaged), logOf(path_));
    if (files.is_closed && files.has_log) without_ = "its log, which is of another map";
    if (!files.is_closed && !files.has_log) without_ = "what its log had: there is none";
  }
  ~WorkingCopy() {
    std::error_code ignored;
    for (const char* end : {"", "-wal", "-shm", "-journal"}) fs::remove(path_ + end, ignored);
  }
  WorkingCopy(const WorkingCopy&) = delete;
  WorkingCopy& operator=(const WorkingCopy&) = delete;

  const std::string& path() const { return path_; }
  /// What of the file it does not have; empty: nothing.
  const std::string& without() const { return without_; }

 private:
  static void copy(const std::string& from, const std::string& to) {
    std::error_code error;
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
    if (error) throw InputError(from + ": cannot be copied to " + to + ": " + error.message());
  }

  std::string path_, without_;
};

}  // namespace

MapRepair repairMap(const std::string& damaged, const std::string& repaired) {
  const std::string part = repaired + ".part" + std::to_string(getpid());
  if (fs::exists(repaired)) {
    throw InputError(repaired + ": is there already, expected the name of a new file");
  }
  MapRepair result;
  try {
    const WorkingCopy copy(damaged, part + ".damaged");
    const SqliteDatabase database(copy.path(), SqliteDatabase::Access::write);
    Salvage salvage(database);
    const MapUpdate found = salvage.gather();
    result.lost = salvage.lost();
    if (!copy.without().empty()) result.lost.push_back(copy.without());
    result.keyframes = found.keyframes.size();
    result.frames = found.frames.size();
    MapWriter(part, MapWriter::Mode::create).write(found);
  } catch (const InputError& error) {
    std::error_code ignored;
    fs::remove(part, ignored);
    throw InputError(damaged + ": cannot be repaired: " + error.what());
  }
  result.kept = MapReader(part).counts();
  renameMapFile(part, repaired);
  return result;
}

}  // namespace pf

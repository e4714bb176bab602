// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <string>
#include <vector>

namespace pf {

/// A file that appears under its name only when it is whole: written beside it under a temporary
/// name, renamed by commit(). Without commit() nothing is left behind.
class AtomicFile {
 public:
  /// What commit() waits for. `disk`: file and name are on the disk, so that a power cut leaves the
  /// old file or the new one. `system`: only the process may die; for the many files of a
  /// recording.
  enum class Until { disk, system };

  /// Throws InputError naming the file when it cannot be made.
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream& stream() { return stream_; }

  /// Throws InputError naming the file when something could not be written (disk full).
  void commit(Until until = Until::disk);

 private:
  std::string path_;
  std::string temporary_;
  std::ofstream stream_;
};

/// The whole of a text file. Throws InputError naming it.
std::string readFile(const std::string& path);

/// ".ply" of "map.ply"; empty where the name has none.
std::string endingOf(const std::string& path);

/// Throws InputError naming the file unless its name ends in one of these, of which there is at
/// least one: ".ply".
void requireEnding(const std::string& path, const std::vector<std::string>& endings);

/// Makes the folder and those above it. Throws InputError naming it when that fails, or when
/// nothing can be written into it.
void makeFolder(const std::string& path);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include <string>

namespace pf::openni2 {

/// Writes streams into an .oni file, by OpenNI2's own recorder and without loss. The file has a
/// temporary name until the recording ends.
class Recording {
 public:
  /// Returns once it records. Throws InputError when the file cannot be made.
  Recording(const std::string& path, openni::VideoStream& color, openni::VideoStream& depth);
  ~Recording();

  /// Ends the recording and names the file. Throws InputError when that fails.
  void finish();
  const std::string& path() const { return path_; }

 private:
  void awaitStart() const;
  void stopAndDestroy();

  std::string path_;
  std::string temporary_;
  openni::Recorder recorder_;
};

}  // namespace pf::openni2

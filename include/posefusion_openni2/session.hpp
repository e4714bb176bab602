// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

namespace pf::openni2 {

/// Keeps the OpenNI2 library initialised, with the drivers it found, while one of these lives. Any
/// thread. Throws InputError when the library cannot start. The library loses 9 kB each time that
/// it is started and stopped: keep one around several devices.
class Session {
 public:
  Session();
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// How often the device of the URI was unplugged since the library started.
  int unplugCount(const std::string& uri) const;

 private:
  class Library;
  std::shared_ptr<Library> library_;
};

}  // namespace pf::openni2

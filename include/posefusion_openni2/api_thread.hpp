// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>

namespace pf::openni2 {

/// A thread that may call OpenNI2. The library keeps a record of every thread that ever called it,
/// and when a new one comes it asks pthread_kill() of all the others whether they still live: for a
/// thread that has ended this reads memory that may be gone, and crashes. The control block of an
/// ApiThread lies in memory that is kept for ever and taken again by the next one. So each thread
/// that calls OpenNI2 is one of these, or lives as long as the process.
class ApiThread {
 public:
  /// Throws std::system_error when there can be no more threads.
  explicit ApiThread(std::function<void()> work);
  /// Waits for its end.
  ~ApiThread();
  ApiThread(const ApiThread&) = delete;
  ApiThread& operator=(const ApiThread&) = delete;

 private:
  struct Running;
  std::unique_ptr<Running> running_;
};

}  // namespace pf::openni2

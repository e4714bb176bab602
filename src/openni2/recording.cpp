// SPDX-License-Identifier: BSD-3-Clause
#include "recording.hpp"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <thread>

#include "posefusion/core/error.hpp"
#include "status.hpp"

namespace posefusion::openni2 {
namespace {

constexpr std::chrono::milliseconds kFrameInFlight(200);

}  // namespace

Recording::Recording(const std::string& path, openni::VideoStream& color,
                     openni::VideoStream& depth)
    : path_(path), temporary_(path + ".part") {
  // The recorder itself does not say why a file cannot be written.
  if (!std::ofstream(temporary_)) {
    throw InputError("recording '" + temporary_ + "' cannot be written: " + std::strerror(errno));
  }
  try {
    check(recorder_.create(temporary_.c_str()), "recording '" + temporary_ + "'");
    check(recorder_.attach(color, false), "the colour stream cannot be recorded");
    check(recorder_.attach(depth, false), "the depth stream cannot be recorded");
    check(recorder_.start(), "recording '" + temporary_ + "' does not start");
  } catch (const InputError&) {
    recorder_.destroy();
    std::remove(temporary_.c_str());
    throw;
  }
}

Recording::~Recording() {
  try {
    finish();
  } catch (const InputError&) {
    // The frames are in the temporary file; a destructor has nobody to tell.
  }
}

void Recording::finish() {
  if (!recorder_.isValid()) return;
  recorder_.stop();
  // Destroying locks the recorder and then each stream; a stream that records a frame locks the
  // other way round, and OpenNI2 hangs. After stop() no frame begins to be recorded: those that had
  // begun, a copy of one image, get the time to end.
  std::this_thread::sleep_for(kFrameInFlight);
  recorder_.destroy();
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    throw InputError("recording '" + temporary_ + "' cannot be renamed to '" + path_ +
                     "': " + std::strerror(errno));
  }
}

}  // namespace posefusion::openni2

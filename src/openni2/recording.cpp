// SPDX-License-Identifier: BSD-3-Clause
#include "recording.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "posefusion/core/error.hpp"
#include "status.hpp"

namespace pf::openni2 {
namespace {

constexpr int kStreams = 2;
constexpr std::chrono::milliseconds kLook(5);
constexpr std::chrono::seconds kStartLimit(5);
constexpr std::chrono::milliseconds kQuiet(200);

/// In how many streams the recorder has begun the data: what it does when it comes to the start.
int begunStreams(const std::string& path) {
  constexpr std::streamoff kFileHeader = 24, kRecordHeader = 28;
  constexpr std::uint32_t kMagic = 0x0052494e, kDataBegin = 8;  // "NIR"
  std::ifstream file(path, std::ios::binary);
  int begun = 0;
  std::streamoff at = kFileHeader;
  std::array<std::uint32_t, 5> record =
      {};  // magic, type, stream, bytes of header and fields, data
  while (begun < kStreams && file.seekg(at) &&
         file.read(reinterpret_cast<char*>(record.data()), sizeof record) && record[0] == kMagic &&
         record[3] >= kRecordHeader) {
    begun += record[1] == kDataBegin;
    at += static_cast<std::streamoff>(record[3]) + record[4];
  }
  return begun;
}

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
    awaitStart();
  } catch (const InputError&) {
    stopAndDestroy();
    std::remove(temporary_.c_str());
    throw;
  }
}

Recording::~Recording() {
  try {
    finish();
  } catch (const InputError&) {
    // The frames are in the temporary file; a destructor cannot report the error.
  }
}

// The recorder takes its orders in a thread of its own, but stop() acts at once: a start that it
// comes to later would have it record for good.
void Recording::awaitStart() const {
  const auto end = std::chrono::steady_clock::now() + kStartLimit;
  while (begunStreams(temporary_) < kStreams) {
    if (std::chrono::steady_clock::now() > end) {
      throw InputError("recording '" + temporary_ + "' does not start: is the disk full?");
    }
    std::this_thread::sleep_for(kLook);
  }
}

// Destroying locks the recorder and then each stream; a stream that records a frame locks the other
// way round, and OpenNI2 hangs. After stop() no frame begins to be recorded: those that had begun
// get the time to end, and the recorder that to write what waits (it holds its lock meanwhile).
void Recording::stopAndDestroy() {
  std::error_code missing;
  for (std::uintmax_t before = 0, size = 1; before != size;) {
    before = std::filesystem::file_size(temporary_, missing);
    recorder_.stop();
    std::this_thread::sleep_for(kQuiet);
    size = std::filesystem::file_size(temporary_, missing);
  }
  recorder_.destroy();
}

void Recording::finish() {
  if (!recorder_.isValid()) return;
  stopAndDestroy();
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    throw InputError("recording '" + temporary_ + "' cannot be renamed to '" + path_ +
                     "': " + std::strerror(errno));
  }
}

}  // namespace pf::openni2

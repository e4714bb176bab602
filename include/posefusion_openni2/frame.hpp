// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>

namespace pf::openni2 {

enum class StreamKind { color, depth };

inline const char* nameOf(StreamKind kind) {
  return kind == StreamKind::color ? "colour" : "depth";
}

/// One whole image as the driver delivered it. Valid only during the call it is passed to.
struct SensorFrame {
  StreamKind kind = StreamKind::color;
  int width = 0;         ///< pixels
  int height = 0;        ///< pixels
  int row_bytes = 0;     ///< bytes of pixels in a row: 3 (R G B) or 2 (mm) each
  int stride_bytes = 0;  ///< bytes from one row to the next, >= row_bytes
  const std::uint8_t* data = nullptr;
  std::int64_t device_time_us = 0;                ///< the device's clock
  int index = 0;                                  ///< the driver's count
  std::chrono::steady_clock::time_point arrival;  ///< when the library announced it
};

/// Takes frames, on a thread of the stream's own: two threads, one for each stream. It must not
/// wait for a thread that opens or closes the device.
using FrameSink = std::function<void(const SensorFrame&)>;

/// What a stream has delivered since it was opened.
struct StreamCounters {
  std::uint64_t delivered = 0;   ///< passed on
  std::uint64_t dropped = 0;     ///< missing in the driver's count
  std::uint64_t duplicated = 0;  ///< came twice, or older than the one before: not passed on
  std::uint64_t damaged = 0;     ///< too short or of the wrong size: not passed on
};

}  // namespace pf::openni2

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include <atomic>
#include <memory>
#include <mutex>

#include "posefusion_openni2/api_thread.hpp"
#include "posefusion_openni2/device.hpp"

namespace pf::openni2 {

/// One stream of an open device: checks every frame and passes the good ones on.
class SensorStream {
 public:
  /// Creates the stream in the wanted mode (a file keeps its own), not mirrored. Throws InputError
  /// that lists what is offered.
  SensorStream(openni::Device& device, StreamKind kind, const StreamMode& wanted);
  ~SensorStream();

  void start();
  /// Of both streams after both have started: with synchronisation the library gives a stream that
  /// runs another frame holder when its partner starts, and destroys the one a reader may be in.
  void startReading(FrameSink sink);
  /// No frame is passed on after it returns. Of both streams before either stops: reading from a
  /// stopped stream, or from one synchronised with it, would block for ever.
  void stopReading();
  void stop();

  StreamInfo info() const;
  StreamCounters counters() const;
  /// Seconds since the last frame, or since start().
  double silence_s() const;
  int lastIndex() const { return last_index_; }
  openni::VideoStream& handle() { return stream_; }

 private:
  void setMode(openni::Device& device, const StreamMode& wanted);
  void readFrames();
  void take(const openni::VideoFrameRef& ref, std::chrono::steady_clock::time_point arrival);
  void count(std::uint64_t StreamCounters::*counter, std::uint64_t by = 1);
  bool isNew(const openni::VideoFrameRef& frame);
  bool isWhole(const openni::VideoFrameRef& frame) const;

  const StreamKind kind_;
  openni::VideoStream stream_;
  openni::VideoMode mode_;
  std::atomic<std::int64_t> last_arrival_ns_{0};
  std::atomic<int> last_index_{0};
  bool any_ = false;
  std::int64_t last_time_us_ = 0;
  mutable std::mutex counters_mutex_;
  StreamCounters counters_;
  FrameSink sink_;
  std::atomic<bool> reading_{false};
  std::unique_ptr<ApiThread> reader_;
};

}  // namespace pf::openni2

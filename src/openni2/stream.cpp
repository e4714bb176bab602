// SPDX-License-Identifier: BSD-3-Clause
#include "stream.hpp"

#include <thread>

#include "modes.hpp"
#include "posefusion/core/error.hpp"
#include "status.hpp"

namespace pf::openni2 {
namespace {

/// Device time that steps back by more is a file's next round or a restarted clock.
constexpr std::int64_t kNewRound_us = 300'000;
/// How soon a reader sees that it shall stop.
constexpr int kWait_ms = 50;

std::int64_t steadyNs() {
  return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

openni::SensorType sensorOf(StreamKind kind) {
  return kind == StreamKind::color ? openni::SENSOR_COLOR : openni::SENSOR_DEPTH;
}

}  // namespace

SensorStream::SensorStream(openni::Device& device, StreamKind kind, const StreamMode& wanted)
    : kind_(kind) {
  const std::string name = nameOf(kind);
  if (!device.hasSensor(sensorOf(kind))) throw InputError("the device has no " + name + " stream");
  check(stream_.create(device, sensorOf(kind)), "the " + name + " stream cannot be made");
  if (!device.isFile()) {
    setMode(device, wanted);
    stream_.setMirroringEnabled(false);
    if (stream_.getMirroringEnabled()) {
      throw InputError("the device does not switch off the mirroring of its " + name + " stream");
    }
  }
  mode_ = stream_.getVideoMode();
  if (mode_.getPixelFormat() != formatOf(kind)) {
    throw InputError("the " + name + " stream of the file is of another pixel format than R G B " +
                     "or 1 mm: " + offersOf(stream_.getSensorInfo()));
  }
}

SensorStream::~SensorStream() {
  stop();
  stream_.destroy();
}

void SensorStream::setMode(openni::Device& device, const StreamMode& wanted) {
  const openni::SensorInfo& sensor = *device.getSensorInfo(sensorOf(kind_));
  const openni::VideoMode mode = chooseMode(sensor, kind_, wanted);
  if (stream_.setVideoMode(mode) == openni::STATUS_OK) return;
  throw InputError(std::string("the device refuses the ") + nameOf(kind_) + " mode " +
                   toText(wanted) + " (" + lastError() + "); it offers " + offersOf(sensor));
}

void SensorStream::start() {
  last_arrival_ns_ = steadyNs();
  check(stream_.start(), std::string("the ") + nameOf(kind_) + " stream does not start");
}

void SensorStream::startReading(FrameSink sink) {
  sink_ = std::move(sink);
  reading_ = true;
  reader_ = std::make_unique<ApiThread>([this] { readFrames(); });
}

void SensorStream::stopReading() {
  reading_ = false;
  reader_.reset();
}

void SensorStream::stop() {
  stopReading();
  stream_.stop();
}

StreamInfo SensorStream::info() const {
  return {{mode_.getResolutionX(), mode_.getResolutionY(), mode_.getFps()},
          stream_.getHorizontalFieldOfView(),
          stream_.getVerticalFieldOfView()};
}

StreamCounters SensorStream::counters() const {
  const std::lock_guard<std::mutex> lock(counters_mutex_);
  return counters_;
}

double SensorStream::silence_s() const {
  return 1e-9 * static_cast<double>(steadyNs() - last_arrival_ns_);
}

void SensorStream::count(std::uint64_t StreamCounters::*counter, std::uint64_t by) {
  const std::lock_guard<std::mutex> lock(counters_mutex_);
  counters_.*counter += by;
}

bool SensorStream::isNew(const openni::VideoFrameRef& frame) {
  const auto time_us = static_cast<std::int64_t>(frame.getTimestamp());
  const int index = frame.getFrameIndex();
  const bool new_round = time_us < last_time_us_ - kNewRound_us;
  const bool is_new = !any_ || new_round || time_us > last_time_us_;
  if (!is_new) return false;
  if (any_ && !new_round && index > last_index_ + 1) {
    count(&StreamCounters::dropped, static_cast<std::uint64_t>(index - last_index_ - 1));
  }
  any_ = true;
  last_time_us_ = time_us;
  last_index_ = index;
  return true;
}

bool SensorStream::isWhole(const openni::VideoFrameRef& frame) const {
  const int width = mode_.getResolutionX(), height = mode_.getResolutionY();
  const int row = width * (kind_ == StreamKind::color ? 3 : 2);
  const int stride = frame.getStrideInBytes();
  return frame.getWidth() == width && frame.getHeight() == height && stride >= row &&
         frame.getData() != nullptr &&
         static_cast<std::int64_t>(frame.getDataSize()) >=
             static_cast<std::int64_t>(stride) * (height - 1) + row;
}

// A thread of ours rather than OpenNI2's listener: that is called on short-lived threads of the
// library, and it calls the library there (see api_thread.hpp).
void SensorStream::readFrames() {
  openni::VideoStream* streams[] = {&stream_};
  while (reading_) {
    int ready = -1;
    const auto status = openni::OpenNI::waitForAnyStream(streams, 1, &ready, kWait_ms);
    const auto arrival = std::chrono::steady_clock::now();
    openni::VideoFrameRef frame;
    if (status == openni::STATUS_OK && stream_.readFrame(&frame) == openni::STATUS_OK) {
      if (frame.isValid()) take(frame, arrival);
    } else if (status != openni::STATUS_TIME_OUT) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kWait_ms));  // a broken device
    }
  }
}

void SensorStream::take(const openni::VideoFrameRef& ref,
                        std::chrono::steady_clock::time_point arrival) {
  last_arrival_ns_ = arrival.time_since_epoch() / std::chrono::nanoseconds(1);
  if (!isNew(ref)) return count(&StreamCounters::duplicated);
  if (!isWhole(ref)) return count(&StreamCounters::damaged);
  SensorFrame frame;
  frame.kind = kind_;
  frame.width = ref.getWidth();
  frame.height = ref.getHeight();
  frame.row_bytes = ref.getWidth() * (kind_ == StreamKind::color ? 3 : 2);
  frame.stride_bytes = ref.getStrideInBytes();
  frame.data = static_cast<const std::uint8_t*>(ref.getData());
  frame.device_time_us = static_cast<std::int64_t>(ref.getTimestamp());
  frame.index = ref.getFrameIndex();
  frame.arrival = arrival;
  count(&StreamCounters::delivered);
  sink_(frame);
}

}  // namespace pf::openni2

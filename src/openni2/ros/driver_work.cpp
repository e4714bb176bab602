// SPDX-License-Identifier: BSD-3-Clause
// What the driver does with an open device besides keeping it open: recording and diagnostics.
#include <ros/console.h>

#include <ctime>
#include <filesystem>

#include "driver.hpp"
#include "posefusion/core/error.hpp"

namespace pf::openni2 {
namespace {

std::string timeText() {
  const std::time_t now = std::time(nullptr);
  std::tm parts = {};
  localtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d-%H-%M-%S", &parts);
  return text;
}

}  // namespace

std::string Driver::recordingPath() const {
  namespace fs = std::filesystem;
  const fs::path folder = fs::absolute(settings_.record_folder).lexically_normal();
  const std::string stem =
      (status_.identity.serial.empty() ? "openni2" : status_.identity.serial) + "_" + timeText();
  fs::path path = folder / (stem + ".oni");
  for (int i = 2; fs::exists(path); ++i) path = folder / (stem + "_" + std::to_string(i) + ".oni");
  return path.string();
}

std::pair<bool, std::string> Driver::recordNow(bool on) {
  if (!device_) return {false, "no camera is open: " + status_.message};
  try {
    if (on) {
      const std::string path = recordingPath();
      device_->startRecording(path);
      ROS_INFO("Recording into %s", path.c_str());
      return {true, path};
    }
    const std::string path = device_->stopRecording();
    if (path.empty()) return {false, "no recording runs"};
    ROS_INFO("Recorded %s", path.c_str());
    return {true, path};
  } catch (const InputError& error) {
    ROS_ERROR("%s", error.what());
    return {false, error.what()};
  }
}

void Driver::updateDiagnostics() {
  const auto now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - last_update_).count();
  last_update_ = now;
  if (device_) {
    if (device_->limitExposure()) {
      status_.exposure_limited = true;
      ROS_WARN(
          "Auto exposure went above max_exposure: held at %d until the exposure settings "
          "change",
          exposure_.max_exposure);
    }
    updateStream(StreamKind::color, status_.color, seconds);
    updateStream(StreamKind::depth, status_.depth, seconds);
    status_.delay_ms = static_cast<double>(clock_->lastDelayNs()) * 1e-6;
    status_.temperature_c = device_->temperature_c();
    status_.exposure = device_->exposure();
    status_.recording = device_->recordingPath();
  }
  updater_.force_update();
}

void Driver::updateStream(StreamKind kind, StreamStatus& status, double seconds) {
  const StreamCounters counters = device_->counters(kind);
  status.rate_hz = static_cast<double>(counters.delivered - status.counters.delivered) / seconds;
  status.counters = counters;
  status.latency_ms = (kind == StreamKind::color ? color_ : depth_).medianLatencyMs();
}

}  // namespace pf::openni2

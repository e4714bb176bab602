// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "posefusion_openni2/frame.hpp"
#include "posefusion_openni2/settings.hpp"

namespace pf::openni2 {

/// Identity of a device.
struct DeviceIdentity {
  std::string uri;
  std::string vendor;
  std::string name;
  std::string serial;  ///< empty when the device reports none
  bool is_file = false;
};

/// What a stream is like, as opened.
struct StreamInfo {
  StreamMode mode;
  double horizontal_fov_rad = 0.0;
  double vertical_fov_rad = 0.0;
};

/// An open RGB-D camera, or an .oni file that plays: streams while it lives. All methods from one
/// thread at a time, which is never the sink's and is an ApiThread or lives as long as the process.
class Device {
 public:
  /// Opens it. Throws InputError when no such device is there, when it may not be opened (names the
  /// udev rule), or when it cannot do what is asked for (lists what it offers).
  explicit Device(const DeviceSettings& settings);
  /// Opens and starts.
  Device(const DeviceSettings& settings, FrameSink sink);
  /// Stops in the order that OpenNI2 needs; no frame comes afterwards.
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Starts both streams, once. Throws InputError when the device does not.
  void start(FrameSink sink);

  const DeviceIdentity& identity() const;
  StreamInfo stream(StreamKind kind) const;
  StreamCounters counters(StreamKind kind) const;
  bool isRegistered() const;
  bool isSynchronised() const;
  /// What was asked for and the device cannot do, though it streams; one sentence each.
  const std::vector<std::string>& warnings() const;

  /// False after the device was unplugged.
  bool isConnected() const;
  /// Seconds since the last frame of the stream that has waited longest.
  double silence_s() const;
  /// A file that is not repeated has played its last frame.
  bool hasEnded() const;

  /// Returns what the device could not do, one sentence each.
  std::vector<std::string> apply(const ExposureSettings& settings);
  /// The exposure the device uses now, in its own steps.
  std::optional<int> exposure() const;
  /// Holds auto exposure at the limit of the last `apply` when it went above. To be called now and
  /// then; true when it has just stepped in.
  bool limitExposure();

  /// Degrees Celsius inside the device; empty when it reports none.
  std::optional<double> temperature_c() const;

  /// Records both streams without loss into an .oni file, first under a temporary name. Throws
  /// InputError when the file cannot be made or a recording runs.
  void startRecording(const std::string& path);
  /// Ends the recording and gives the file its name. Returns the path, empty when none ran.
  std::string stopRecording();
  /// The path of the recording that runs, or empty.
  std::string recordingPath() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pf::openni2

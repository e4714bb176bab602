// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "driver_settings.hpp"
#include "driver_status.hpp"
#include "posefusion_openni2/api_thread.hpp"
#include "posefusion_openni2/session.hpp"
#include "stream_publisher.hpp"

namespace pf::openni2 {

/// Keeps a camera open and publishes it: looks for it, opens it, opens it again when it was
/// unplugged or went silent. One thread owns the device; the others leave it requests.
class Driver {
 public:
  Driver(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh, const std::string& name);
  ~Driver();

  /// Begins to look for the camera. Once, with the first settings made.
  void start();

  /// Takes effect soon, also on devices opened later. Any thread.
  void setExposure(const ExposureSettings& settings);
  void setTimeOffsets(double color_s, double depth_s);
  /// Starts or ends recording; waits for the device's thread. The answer says where the file is, or
  /// why there is none.
  std::pair<bool, std::string> record(bool on);

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  void runRequests();
  void supervise();
  void open();
  void noteOpened();
  void close(const std::string& why);
  void watch();
  void applyExposure();
  std::pair<bool, std::string> recordNow(bool on);
  std::string recordingPath() const;
  void onFrame(const SensorFrame& frame, ClockMap& clock);
  void updateDiagnostics();
  void updateStream(StreamKind kind, StreamStatus& status, double seconds);

  const DriverSettings settings_;
  const std::shared_ptr<CameraInfos> color_infos_;
  const std::shared_ptr<CameraInfos> depth_infos_;
  StreamPublisher color_;
  StreamPublisher depth_;
  diagnostic_updater::Updater updater_;

  // Of the device's thread.
  std::unique_ptr<Session> session_;
  std::shared_ptr<ClockMap> clock_;
  DriverStatus status_;
  ExposureSettings exposure_;
  std::string last_problem_;
  Clock::time_point next_look_;
  Clock::time_point last_update_;
  std::unique_ptr<Device> device_;

  std::mutex requests_mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> requests_;
  bool stopping_ = false;
  std::unique_ptr<ApiThread> thread_;
};

}  // namespace pf::openni2

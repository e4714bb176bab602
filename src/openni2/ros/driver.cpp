// SPDX-License-Identifier: BSD-3-Clause
#include "driver.hpp"

#include <ros/console.h>

#include <future>

#include "posefusion/core/error.hpp"
#include "posefusion_openni2/discovery.hpp"

namespace pf::openni2 {
namespace {

constexpr auto kStep = std::chrono::milliseconds(100);
constexpr auto kDiagnosticPeriod = std::chrono::seconds(1);
constexpr auto kAnswerLimit = std::chrono::seconds(10);

std::string depthTopic(const DriverSettings& settings) {
  return settings.device.depth_registration ? "depth_registered" : "depth";
}

std::string labelOf(const DeviceIdentity& identity) {
  return identity.vendor + " " + identity.name + " (" + identity.uri +
         (identity.serial.empty() ? "" : ", serial number " + identity.serial) + ")";
}

/// What its calibration is filed under.
std::string calibrationOf(const char* imager, const DeviceIdentity& identity) {
  return std::string(imager) + "_" + (identity.serial.empty() ? identity.name : identity.serial);
}

}  // namespace

Driver::Driver(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
               const std::string& name)
    : settings_(readDriverSettings(private_nh)),
      color_infos_(
          std::make_shared<CameraInfos>(ros::NodeHandle(nh, "rgb"), settings_.rgb_camera_info_url)),
      depth_infos_(settings_.device.depth_registration
                       ? color_infos_
                       : std::make_shared<CameraInfos>(ros::NodeHandle(nh, "depth"),
                                                       settings_.depth_camera_info_url)),
      color_(nh, {"rgb", settings_.rgb_frame_id}, color_infos_),
      depth_(
          nh,
          {depthTopic(settings_),
           settings_.device.depth_registration ? settings_.rgb_frame_id : settings_.depth_frame_id},
          depth_infos_),
      updater_(nh, private_nh, name) {
  updater_.setHardwareID("none yet");
  updater_.add("OpenNI2 camera", [this](auto& out) { report(status_, out); });
}

void Driver::start() {
  thread_ = std::make_unique<ApiThread>([this] { run(); });
}

Driver::~Driver() {
  {
    const std::lock_guard<std::mutex> lock(requests_mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.reset();
}

void Driver::setExposure(const ExposureSettings& settings) {
  const std::lock_guard<std::mutex> lock(requests_mutex_);
  requests_.push_back([this, settings] {
    exposure_ = settings;
    applyExposure();
  });
  wake_.notify_one();
}

void Driver::setTimeOffsets(double color_s, double depth_s) {
  color_.setTimeOffset(color_s);
  depth_.setTimeOffset(depth_s);
}

std::pair<bool, std::string> Driver::record(bool on) {
  using Answer = std::pair<bool, std::string>;
  auto task = std::make_shared<std::packaged_task<Answer()>>([this, on] { return recordNow(on); });
  auto answer = task->get_future();
  {
    const std::lock_guard<std::mutex> lock(requests_mutex_);
    if (stopping_) return {false, "the driver is being unloaded"};
    requests_.push_back([task] { (*task)(); });
  }
  task.reset();  // the queue's copy is the last: the answer is broken off when that is dropped
  wake_.notify_one();
  if (answer.wait_for(kAnswerLimit) != std::future_status::ready) {
    return {false, "the camera does not answer"};
  }
  try {
    return answer.get();
  } catch (const std::future_error&) {
    return {false, "the driver is being unloaded"};
  }
}

void Driver::run() {
  for (;;) {
    runRequests();
    {
      std::unique_lock<std::mutex> lock(requests_mutex_);
      if (stopping_) break;
    }
    supervise();
    if (Clock::now() - last_update_ >= kDiagnosticPeriod) updateDiagnostics();
    std::unique_lock<std::mutex> lock(requests_mutex_);
    wake_.wait_for(lock, kStep, [this] { return stopping_ || !requests_.empty(); });
  }
  device_.reset();
  session_.reset();
  const std::lock_guard<std::mutex> lock(requests_mutex_);
  requests_.clear();
}

void Driver::runRequests() {
  for (;;) {
    std::function<void()> request;
    {
      const std::lock_guard<std::mutex> lock(requests_mutex_);
      if (requests_.empty() || stopping_) return;
      request = std::move(requests_.front());
      requests_.pop_front();
    }
    request();
  }
}

void Driver::supervise() {
  if (device_) return watch();
  if (status_.state == DriverStatus::State::ended || Clock::now() < next_look_) return;
  try {
    open();
  } catch (const InputError& error) {
    status_.message = error.what();
    if (status_.message != last_problem_) {
      ROS_ERROR("%s. Looking again every %.1f s.", error.what(), settings_.reconnect_period_s);
    }
    last_problem_ = status_.message;
    next_look_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                    std::chrono::duration<double>(settings_.reconnect_period_s));
  }
}

void Driver::open() {
  if (!session_) session_ = std::make_unique<Session>();
  const bool is_file = isFileName(settings_.device.device);
  const auto clock =
      std::make_shared<ClockMap>(is_file ? ClockMap::Source::recorded : ClockMap::Source::live);
  auto device = std::make_unique<Device>(settings_.device);
  const DeviceIdentity& identity = device->identity();
  color_infos_->use(calibrationOf("rgb", identity), device->stream(StreamKind::color));
  if (depth_infos_ != color_infos_) {
    depth_infos_->use(calibrationOf("depth", identity), device->stream(StreamKind::depth));
  }
  device->start([this, clock](const SensorFrame& frame) { onFrame(frame, *clock); });
  device_ = std::move(device);
  clock_ = clock;
  noteOpened();
  applyExposure();
}

void Driver::noteOpened() {
  last_problem_.clear();
  last_update_ = Clock::now();
  const int connections = status_.connections + 1;
  status_ = DriverStatus{};
  status_.state = DriverStatus::State::streaming;
  status_.connections = connections;
  status_.identity = device_->identity();
  status_.color.mode = device_->stream(StreamKind::color).mode;
  status_.depth.mode = device_->stream(StreamKind::depth).mode;
  status_.registered = device_->isRegistered();
  status_.synchronised = device_->isSynchronised();
  updater_.setHardwareID(status_.identity.serial.empty() ? status_.identity.uri
                                                         : status_.identity.serial);
  ROS_INFO("Opened %s: colour %s, depth %s", labelOf(status_.identity).c_str(),
           toText(status_.color.mode).c_str(), toText(status_.depth.mode).c_str());
  for (const auto& warning : device_->warnings()) ROS_WARN("%s", warning.c_str());
}

void Driver::close(const std::string& why) {
  const std::string recording = device_->recordingPath();
  device_.reset();
  status_.message = why;
  last_problem_.clear();
  next_look_ = {};
  if (!recording.empty()) ROS_WARN("The recording ended early: %s", recording.c_str());
}

void Driver::watch() {
  if (device_->hasEnded()) {
    close("");
    status_.state = DriverStatus::State::ended;
    ROS_INFO("Played %s to its end", status_.identity.uri.c_str());
  } else if (!device_->isConnected()) {
    close("the camera was unplugged");
    status_.state = DriverStatus::State::looking;
    ROS_ERROR("%s was unplugged. Waiting for it.", labelOf(status_.identity).c_str());
  } else if (device_->silence_s() > settings_.stall_timeout_s) {
    close("the camera went silent");
    status_.state = DriverStatus::State::looking;
    ROS_ERROR("%s sends no frames for %.1f s. Opening it again.", labelOf(status_.identity).c_str(),
              settings_.stall_timeout_s);
  }
}

void Driver::applyExposure() {
  if (!device_) return;
  status_.exposure_limited = false;
  for (const auto& failure : device_->apply(exposure_)) ROS_WARN("%s", failure.c_str());
}

void Driver::onFrame(const SensorFrame& frame, ClockMap& clock) {
  (frame.kind == StreamKind::color ? color_ : depth_).publish(frame, clock);
}

}  // namespace pf::openni2

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_openni2/device.hpp"

#include <PS1080.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "exposure.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion_openni2/discovery.hpp"
#include "posefusion_openni2/session.hpp"
#include "posefusion_openni2/usb_access.hpp"
#include "recording.hpp"
#include "status.hpp"
#include "stream.hpp"

namespace pf::openni2 {
namespace {

/// Closes what it opened.
struct OpenDevice {
  explicit OpenDevice(const std::string& uri) {
    if (device.open(uri.c_str()) == openni::STATUS_OK) return;
    const std::string reason = lastError();
    const std::string permission = isFileName(uri) ? "" : missingUsbPermission();
    throw InputError("the device '" + uri + "' cannot be opened: " + reason +
                     (permission.empty() ? "" : "; " + permission));
  }
  ~OpenDevice() { device.close(); }

  openni::Device device;
};

DeviceIdentity identify(openni::Device& device, const std::string& uri) {
  DeviceIdentity identity;
  identity.uri = uri;
  identity.vendor = device.getDeviceInfo().getVendor();
  identity.name = device.getDeviceInfo().getName();
  identity.is_file = device.isFile();
  char serial[ONI_MAX_STR] = {};
  int size = sizeof serial;
  if (device.getProperty(ONI_DEVICE_PROPERTY_SERIAL_NUMBER, serial, &size) == openni::STATUS_OK) {
    identity.serial.assign(serial, strnlen(serial, sizeof serial));
  }
  return identity;
}

}  // namespace

// The order of the members is the order of opening; its reverse is the only order of closing in
// which OpenNI2 neither deadlocks nor crashes: streams (stopped before the recording ends), device,
// library.
struct Device::Impl {
  explicit Impl(const DeviceSettings& settings)
      : settings(settings),
        uri(findUri(settings.device)),
        unplugs_before(session.unplugCount(uri)),
        open(uri),
        identity(identify(open.device, uri)),
        color(open.device, StreamKind::color, settings.color_mode),
        depth(open.device, StreamKind::depth, settings.depth_mode),
        exposure(color.handle()) {
    if (identity.is_file) setPlayback();
    setRegistration();
    setSync();
  }
  ~Impl() {
    color.stopReading();
    depth.stopReading();
    color.stop();
    depth.stop();
    recording.reset();
    // The player of files walks its list of streams without a lock when it is woken by the end of
    // one; destroying a stream at that moment crashes it.
    if (identity.is_file) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }

  void setPlayback();
  void setRegistration();
  void setSync();
  const SensorStream& of(StreamKind kind) const {
    return kind == StreamKind::color ? color : depth;
  }

  const DeviceSettings settings;
  Session session;
  std::string uri;
  const int unplugs_before;
  OpenDevice open;
  DeviceIdentity identity;
  SensorStream color;
  SensorStream depth;
  ExposureControl exposure;
  std::unique_ptr<Recording> recording;
  std::vector<std::string> warnings;
  bool registered = false;
  bool synchronised = false;
};

void Device::Impl::setPlayback() {
  if (!(settings.file_speed > 0.0 && settings.file_speed <= 100.0)) {
    throw InputError("file_speed is " + std::to_string(settings.file_speed) +
                     ", expected above 0 to 100");
  }
  openni::PlaybackControl* playback = open.device.getPlaybackControl();
  if (playback == nullptr) throw InputError("the file '" + uri + "' cannot be played");
  check(playback->setSpeed(static_cast<float>(settings.file_speed)), "the playing speed");
  check(playback->setRepeatEnabled(settings.file_repeat), "repeating the file");
}

void Device::Impl::setRegistration() {
  registered = settings.depth_registration;
  if (identity.is_file) return;  // its depth is as it was recorded
  const auto mode =
      registered ? openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR : openni::IMAGE_REGISTRATION_OFF;
  const bool known = open.device.isImageRegistrationModeSupported(mode);
  const bool set = known && open.device.setImageRegistrationMode(mode) == openni::STATUS_OK;
  if (set) return;
  if (registered) {
    throw InputError(
        "the device cannot register its depth to the colour image in these modes; "
        "set depth_registration to false and register by depth_image_proc");
  }
  warnings.push_back("the device does not switch off the registration of its depth");
}

void Device::Impl::setSync() {
  if (identity.is_file) return;
  const auto status = open.device.setDepthColorSyncEnabled(settings.frame_sync);
  synchronised = settings.frame_sync && status == openni::STATUS_OK;
  if (settings.frame_sync && !synchronised) {
    warnings.push_back("the device does not synchronise its streams (" + lastError() +
                       "): colour and depth may be up to half a frame apart");
  }
}

Device::Device(const DeviceSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}

Device::Device(const DeviceSettings& settings, FrameSink sink) : Device(settings) {
  start(std::move(sink));
}

void Device::start(FrameSink sink) {
  impl_->color.start();
  impl_->depth.start();
  impl_->color.startReading(sink);
  impl_->depth.startReading(std::move(sink));
}

Device::~Device() = default;

const DeviceIdentity& Device::identity() const { return impl_->identity; }
StreamInfo Device::stream(StreamKind kind) const { return impl_->of(kind).info(); }
StreamCounters Device::counters(StreamKind kind) const { return impl_->of(kind).counters(); }
bool Device::isRegistered() const { return impl_->registered; }
bool Device::isSynchronised() const { return impl_->synchronised; }
const std::vector<std::string>& Device::warnings() const { return impl_->warnings; }
bool Device::isConnected() const {
  return impl_->session.unplugCount(impl_->uri) == impl_->unplugs_before;
}

double Device::silence_s() const {
  return std::max(impl_->color.silence_s(), impl_->depth.silence_s());
}

bool Device::hasEnded() const {
  if (!impl_->identity.is_file || impl_->settings.file_repeat) return false;
  openni::PlaybackControl* playback = impl_->open.device.getPlaybackControl();
  return impl_->color.lastIndex() >= playback->getNumberOfFrames(impl_->color.handle()) &&
         impl_->depth.lastIndex() >= playback->getNumberOfFrames(impl_->depth.handle());
}

std::vector<std::string> Device::apply(const ExposureSettings& settings) {
  if (impl_->identity.is_file) return {};  // what was recorded stays as it is
  return impl_->exposure.apply(settings);
}

std::optional<int> Device::exposure() const { return impl_->exposure.exposure(); }
bool Device::limitExposure() { return impl_->exposure.limit(); }

std::optional<double> Device::temperature_c() const {
  // The only temperature in OpenNI2: that of PS1080 devices with a heated laser.
  XnTecFastConvergenceData data = {};
  int size = sizeof data;
  const auto status =
      impl_->open.device.getProperty(XN_MODULE_PROPERTY_TEC_FAST_CONVERGENCE_STATUS, &data, &size);
  if (status != openni::STATUS_OK) return std::nullopt;
  return data.m_MeasuredTemperature / 100.0;
}

void Device::startRecording(const std::string& path) {
  if (impl_->recording) {
    throw InputError("a recording runs already: " + impl_->recording->path());
  }
  impl_->recording =
      std::make_unique<Recording>(path, impl_->color.handle(), impl_->depth.handle());
}

std::string Device::stopRecording() {
  if (!impl_->recording) return "";
  const auto recording = std::move(impl_->recording);
  recording->finish();
  return recording->path();
}

std::string Device::recordingPath() const {
  return impl_->recording ? impl_->recording->path() : "";
}

}  // namespace pf::openni2

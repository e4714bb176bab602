// SPDX-License-Identifier: BSD-3-Clause
#include <PS1080.h>

#include <cstdio>
#include <cstring>
#include <memory>

#include "virtual_stream.hpp"

namespace pf::openni2 {
namespace {

VirtualDevice g_devices[kVirtualDevices];

std::string uriOf(int number) { return "virtual/" + std::to_string(number); }

class VirtualCamera : public oni::driver::DeviceBase {
 public:
  explicit VirtualCamera(int number) : number_(number), device_(g_devices[number]) {
    ++device_.opened;
    for (const auto sensor : {ONI_SENSOR_COLOR, ONI_SENSOR_DEPTH}) {
      const auto& modes = virtualModes(sensor);
      sensors_.push_back(
          {sensor, static_cast<int>(modes.size()), const_cast<OniVideoMode*>(modes.data())});
    }
  }
  ~VirtualCamera() override { ++device_.closed; }

  OniStatus getSensorInfoList(OniSensorInfo** infos, int* count) override {
    *infos = sensors_.data();
    *count = static_cast<int>(sensors_.size());
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType sensor) override {
    return new VirtualStream(device_, sensor, started_);
  }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || !device_.refuses_registration;
  }

  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || size != sizeof(int)) {
      return ONI_STATUS_NOT_IMPLEMENTED;
    }
    device_.registration = *static_cast<const int*>(data);
    return ONI_STATUS_OK;
  }

  OniStatus getProperty(int id, void* data, int* size) override {
    if (id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER) {
      return answer("V000" + std::to_string(number_ + 1), data, size);
    }
    if (id == XN_MODULE_PROPERTY_TEC_FAST_CONVERGENCE_STATUS && device_.temperature_c100 != 0) {
      XnTecFastConvergenceData status = {};
      status.m_MeasuredTemperature = static_cast<int16_t>(device_.temperature_c100);
      std::memcpy(data, &status, sizeof status);
      return ONI_STATUS_OK;
    }
    if (id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) {
      const int mode = device_.registration == 1;
      std::memcpy(data, &mode, sizeof mode);
      return ONI_STATUS_OK;
    }
    return ONI_STATUS_NOT_IMPLEMENTED;
  }

  OniBool isPropertySupported(int id) override {
    return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || id == ONI_DEVICE_PROPERTY_SERIAL_NUMBER;
  }

  VirtualDevice& device() { return device_; }

 private:
  static OniStatus answer(const std::string& text, void* data, int* size) {
    if (*size <= static_cast<int>(text.size())) return ONI_STATUS_BAD_PARAMETER;
    std::memcpy(data, text.c_str(), text.size() + 1);
    *size = static_cast<int>(text.size()) + 1;
    return ONI_STATUS_OK;
  }

  const int number_;
  VirtualDevice& device_;
  const VirtualStream::Clock::time_point started_ = VirtualStream::Clock::now();
  std::vector<OniSensorInfo> sensors_;
};

class VirtualDriver : public oni::driver::DriverBase {
 public:
  explicit VirtualDriver(OniDriverServices* services) : DriverBase(services) {}

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    for (int i = 0; i < kVirtualDevices; ++i) {
      describe(i);
      g_devices[i].plug = [this, i](bool in) { plug(i, in); };
      if (g_devices[i].plugged) deviceConnected(&infos_[i]);
    }
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    for (int i = 0; i < kVirtualDevices; ++i) {
      if (uriOf(i) != uri || !g_devices[i].plugged) continue;
      if (!g_devices[i].refuses_open) return new VirtualCamera(i);
      getServices().errorLoggerAppend("the virtual camera refuses to open");
    }
    return nullptr;
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }

  void* enableFrameSync(oni::driver::StreamBase** streams, int count) override {
    return setSync(streams, count);
  }
  void disableFrameSync(void*) override {}

  /// Unplugging can be reported at any time, also while no library runs.
  void shutdown() override {
    for (auto& device : g_devices) device.plug = [&device](bool in) { device.plugged = in; };
  }

 private:
  void* setSync(oni::driver::StreamBase**, int) {
    for (auto& device : g_devices) {
      if (device.refuses_sync) return nullptr;
      if (device.open_streams > 0) device.sync = 1;
    }
    return this;
  }

  void describe(int i) {
    infos_[i] = {};
    std::snprintf(infos_[i].uri, sizeof infos_[i].uri, "%s", uriOf(i).c_str());
    std::snprintf(infos_[i].vendor, sizeof infos_[i].vendor, "posefusion");
    std::snprintf(infos_[i].name, sizeof infos_[i].name, "virtual camera");
  }

  void plug(int i, bool in) {
    if (g_devices[i].plugged.exchange(in) == in) return;
    in ? deviceConnected(&infos_[i]) : deviceDisconnected(&infos_[i]);
  }

  OniDeviceInfo infos_[kVirtualDevices];
};

struct Initially {
  Initially() {
    g_devices[0].plugged = true;
    for (auto& device : g_devices) device.plug = [&device](bool in) { device.plugged = in; };
  }
} g_initially;

}  // namespace
}  // namespace pf::openni2

ONI_C_API_EXPORT pf::openni2::VirtualDevice* posefusionVirtualDevice(int number) {
  return &pf::openni2::g_devices[number];
}

using pf::openni2::VirtualDriver;
ONI_EXPORT_DRIVER(VirtualDriver)

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(p) delete (p)
#include <Driver/OniDriverAPI.h>

#include <chrono>
#include <thread>
#include <vector>

#include "virtual_device.hpp"

namespace pf::openni2 {

/// The modes of the sensor, as OpenNI2 requires them.
const std::vector<OniVideoMode>& virtualModes(OniSensorType sensor);

/// One stream of the virtual camera, with a thread that sends its frames in real time.
class VirtualStream : public oni::driver::StreamBase {
 public:
  using Clock = std::chrono::steady_clock;

  /// `started`: when the camera's clock was at its frame 0.
  VirtualStream(VirtualDevice& device, OniSensorType sensor, Clock::time_point started);
  ~VirtualStream() override;

  OniStatus start() override;
  void stop() override;
  OniStatus setProperty(int id, const void* data, int size) override;
  OniStatus getProperty(int id, void* data, int* size) override;
  OniBool isPropertySupported(int id) override;
  void notifyAllProperties() override;

 private:
  bool isColor() const { return sensor_ == ONI_SENSOR_COLOR; }
  int stride() const { return mode_.resolutionX * (isColor() ? 3 : 2); }
  OniStatus setMode(const OniVideoMode& mode);
  OniStatus setCamera(int id, int value);
  OniStatus getCamera(int id, void* data, int* size) const;
  float fov(bool horizontal) const;
  void run();
  void sendUnlessSilent(int index);
  void send(int index);
  void raise(int index, bool cut);

  VirtualDevice& device_;
  const OniSensorType sensor_;
  const Clock::time_point started_;
  OniVideoMode mode_;
  std::atomic<bool> running_{false};
  std::thread thread_;
};

}  // namespace pf::openni2

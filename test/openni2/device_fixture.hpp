// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <thread>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion_openni2/device.hpp"
#include "posefusion_openni2/session.hpp"
#include "virtual_device.hpp"

namespace pf::openni2 {

/// The virtual camera of this process. The module stays loaded, so that its settings outlive a
/// restart of the library.
inline VirtualDevice& virtualDevice(int number = 0) {
  static void* const module = dlopen(POSEFUSION_VIRTUAL_DRIVER, RTLD_NOW | RTLD_NODELETE);
  if (module == nullptr) throw std::runtime_error(dlerror());
  using Getter = VirtualDevice* (*)(int);
  return *reinterpret_cast<Getter>(dlsym(module, "posefusionVirtualDevice"))(number);
}

/// Resets the camera to its normal behaviour, whatever the test before has set.
inline void resetVirtualDevice(int number) {
  VirtualDevice& device = virtualDevice(number);
  for (auto* flag : {&device.stalled, &device.refuses_open, &device.refuses_modes,
                     &device.refuses_registration, &device.refuses_sync, &device.keeps_mirroring}) {
    *flag = false;
  }
  for (auto* value :
       {&device.late_every, &device.late_by_ms, &device.duplicate_every, &device.short_every,
        &device.drop_every, &device.temperature_c100, &device.notify_ms}) {
    *value = 0;
  }
  for (auto* asked :
       {&device.registration, &device.sync, &device.mirroring[0], &device.mirroring[1],
        &device.auto_exposure, &device.auto_white_balance, &device.exposure, &device.gain}) {
    *asked = -1;
  }
  device.has_camera_settings = true;
  device.automatic_exposure = 20;
  device.plug(number == 0);
}

/// Waits until the condition holds; false after ten seconds.
template <typename Condition>
bool eventually(Condition condition, int limit_ms = 10000) {
  for (int waited = 0; waited < limit_ms; waited += 5) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

/// A frame with its pixels, rows without gaps.
struct KeptFrame {
  int index = 0;
  int width = 0;
  int height = 0;
  std::int64_t device_time_us = 0;
  std::vector<std::uint8_t> pixels;
};

/// Keeps what a device delivers.
class FrameKeeper {
 public:
  FrameSink sink() {
    return [this](const SensorFrame& frame) { keep(frame); };
  }
  std::vector<KeptFrame> frames(StreamKind kind) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return kind == StreamKind::color ? color_ : depth_;
  }
  std::size_t count(StreamKind kind) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return (kind == StreamKind::color ? color_ : depth_).size();
  }
  /// Waits for n frames of each stream.
  bool waitFor(std::size_t n) const {
    return eventually(
        [&] { return count(StreamKind::color) >= n && count(StreamKind::depth) >= n; });
  }

 private:
  void keep(const SensorFrame& frame) {
    KeptFrame kept{frame.index, frame.width, frame.height, frame.device_time_us, {}};
    for (int y = 0; y < frame.height; ++y) {
      const auto* row = frame.data + static_cast<std::ptrdiff_t>(y) * frame.stride_bytes;
      kept.pixels.insert(kept.pixels.end(), row, row + frame.row_bytes);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    (frame.kind == StreamKind::color ? color_ : depth_).push_back(std::move(kept));
  }

  mutable std::mutex mutex_;
  std::vector<KeptFrame> color_, depth_;
};

/// The pixels that the virtual camera sent with this index.
inline std::vector<std::uint8_t> servedPixels(StreamKind kind, const KeptFrame& frame, int index) {
  const auto n = static_cast<std::size_t>(frame.width * frame.height);
  if (kind == StreamKind::color) {
    std::vector<std::uint8_t> rgb(n * 3);
    virtualColor(index, frame.width, frame.height, rgb.data());
    return rgb;
  }
  std::vector<std::uint16_t> mm(n);
  virtualDepth(index, frame.width, frame.height, mm.data());
  std::vector<std::uint8_t> bytes(n * 2);
  std::memcpy(bytes.data(), mm.data(), bytes.size());
  return bytes;
}

/// What the action throws; empty when nothing.
template <typename Action>
std::string errorOf(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

class DeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 0; i < kVirtualDevices; ++i) resetVirtualDevice(i);
  }
  void TearDown() override {
    EXPECT_EQ(virtualDevice().running_streams, 0);
    EXPECT_EQ(virtualDevice().open_streams, 0);
    EXPECT_EQ(virtualDevice().opened, virtualDevice().closed);
  }
};

/// Fails with what was found when the text does not contain the part.
inline testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "'" << text << "' does not contain '" << part << "'";
}

}  // namespace pf::openni2

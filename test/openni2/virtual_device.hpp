// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace pf::openni2 {

/// A virtual camera, served to the real OpenNI2 library by a driver module made for tests only. A
/// test in the same process reaches it through virtualDevice(), to set the camera's behaviour and
/// to read what the library requested.
struct VirtualDevice {
  // How it behaves. May change at any time.
  std::atomic<bool> stalled{false};  ///< sends nothing
  std::atomic<int> late_every{0};    ///< each n-th frame comes late (0: none)
  std::atomic<int> late_by_ms{0};
  std::atomic<int> duplicate_every{0};  ///< each n-th frame is sent twice
  std::atomic<int> short_every{0};      ///< each n-th frame is cut in half
  std::atomic<int> drop_every{0};       ///< each n-th frame is not sent
  std::atomic<bool> refuses_open{false};
  std::atomic<bool> refuses_modes{false};
  std::atomic<bool> refuses_registration{false};
  std::atomic<bool> refuses_sync{false};
  std::atomic<bool> keeps_mirroring{false};
  std::atomic<bool> has_camera_settings{true};
  std::atomic<int> notify_ms{0};  ///< time it takes to report its properties to a recorder
  std::atomic<int> automatic_exposure{20};  ///< what its auto exposure chooses
  std::atomic<int> temperature_c100{0};     ///< hundredths of degrees; 0: reports none

  // What the library requested; -1: nothing.
  std::atomic<int> registration{-1};
  std::atomic<int> sync{-1};
  std::array<std::atomic<int>, 2> mirroring{-1, -1};  ///< colour, depth
  std::atomic<int> auto_exposure{-1};
  std::atomic<int> auto_white_balance{-1};
  std::atomic<int> exposure{-1};
  std::atomic<int> gain{-1};
  std::atomic<int> opened{0};  ///< how often
  std::atomic<int> closed{0};
  std::atomic<int> open_streams{0};     ///< now
  std::atomic<int> running_streams{0};  ///< now
  std::atomic<int> sent{0};             ///< frames of both streams
  std::atomic<int> under_way{0};        ///< streams that are giving the library a frame

  /// Steady clock when the last frame was given to the library, nanoseconds: colour, depth.
  std::array<std::atomic<std::int64_t>, 2> raised_ns{0, 0};

  /// Plugs the camera in or out.
  std::function<void(bool)> plug;
  std::atomic<bool> plugged{false};
};

/// Serves "virtual/0" (plugged in from the start) and "virtual/1"; serial numbers V0001, V0002.
inline constexpr int kVirtualDevices = 2;

/// Device time of the frame with this index.
inline std::int64_t virtualTimeUs(int index, int fps) {
  return 5'000'000 + static_cast<std::int64_t>(index) * 1'000'000 / fps;
}

/// Some bits that look random and depend on everything.
inline std::uint32_t virtualNoise(int index, int i) {
  std::uint32_t h = static_cast<std::uint32_t>(index) * 2654435761u ^ static_cast<std::uint32_t>(i);
  h ^= h >> 15;
  return h * 2246822519u >> 24;
}

/// R G B pixels of the frame with this index: a textured wall, with noise in the lowest bits.
inline void virtualColor(int index, int width, int height, std::uint8_t* rgb) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, rgb += 3) {
      const int block = (x / 16 * 7 + y / 16 * 13) * 37;
      const std::uint32_t noise = virtualNoise(index, y * width + x);
      rgb[0] = static_cast<std::uint8_t>((block & 0x7c) + x * 100 / width + (noise & 3));
      rgb[1] = static_cast<std::uint8_t>((block >> 2 & 0x7c) + y * 100 / height + (noise >> 2 & 3));
      rgb[2] = static_cast<std::uint8_t>((block >> 3 & 0x7c) + (noise >> 4 & 3));
    }
  }
}

/// Depth in millimetres of the frame with this index: a slanted wall with steps and a hole.
inline void virtualDepth(int index, int width, int height, std::uint16_t* mm) {
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, ++mm) {
      const bool hole = x < width / 20 && y < height / 20;
      const int wall = 1200 + x * 800 / width + y * 300 / height + (x / 80 + y / 80) % 2 * 150;
      *mm = hole ? 0 : static_cast<std::uint16_t>(wall + virtualNoise(index, x + y * width) % 4);
    }
  }
}

}  // namespace pf::openni2

/// The camera in this process's driver module.
extern "C" pf::openni2::VirtualDevice* posefusionVirtualDevice(int number);

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "simulator/depth_config.hpp"
#include "simulator/renderer.hpp"

namespace pf::simulator {

/// One picture that a depth camera takes. What it names has to outlive it.
struct DepthShot {
  const DepthView& view;  ///< what is there
  const PinholeCamera& camera;
  const DepthConfig& config;
  std::uint32_t key = 0;  ///< of the frame's noise
  double time_s = 0.0;    ///< since the camera was switched on
};

/// A kind of depth camera at work on one picture. Rows are independent: the result does not depend
/// on the number of threads. Thread safe.
class DepthKind {
 public:
  virtual ~DepthKind() = default;
  /// Fills a row: depth (m; 0: none) and the label of DepthView that it came from.
  virtual void sense(int row, float* depth_m, std::uint8_t* label) const = 0;
};

/// A projected pattern seen from beside (Xtion, Kinect); without `config.noise` the exact depth.
std::unique_ptr<DepthKind> makeStructuredLight(const DepthShot& shot);
/// The phase of modulated light (Kinect for Xbox One, Azure Kinect).
std::unique_ptr<DepthKind> makeTimeOfFlight(const DepthShot& shot);
/// Two infrared cameras and a pattern that gives texture (RealSense D400).
std::unique_ptr<DepthKind> makeActiveStereo(const DepthShot& shot);

/// Marks (1) what the second eye, the baseline to the right, does not see: a projector or another
/// camera. In its picture near things lie further left: going left, whatever lies right of what was
/// already met is covered by it.
void markShadow(const DepthShot& shot, int row, std::vector<char>& shadow);

/// Chance that a shiny surface gives no depth. Seen head on the reflection blinds, seen flat
/// nothing comes back.
float glareChance(float theta_rad, float gloss);

/// The column that a pixel's depth is taken from where it is badly registered.
int registeredFrom(const DepthShot& shot, int col);

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "posefusion/frame/model_view.hpp"
#include "posefusion/frame/working_frame.hpp"

namespace pf {

/// Planes of one size: depth (m, 0 = nothing), unit normal, grey level, odds (nats, see
/// static_odds).
struct ModelPlanes {
  cv::Mat depth_m, normal[3], intensity, odds;
};

/// The pixels of a model view that show something, as structure of arrays in the view's camera
/// frame, in the order of the image. Padded with invisible points to whole groups of kLanes.
struct ModelPoints {
  static constexpr std::size_t kLanes = 16;

  std::vector<float> x, y, z;     ///< metres
  std::vector<float> nx, ny, nz;  ///< unit normal
  std::vector<float> intensity;   ///< 0..255
  std::vector<float> weight;      ///< (0, 1], less for what the map has not known for long
  std::size_t count = 0;          ///< without the padding

  void assign(const PinholeCamera& camera, const ModelPlanes& planes);
};

/// The points of a model view on the levels of the pyramid, finest first.
class ModelPyramid {
 public:
  /// `fill`: finest level of the frame that was fused at the view's pose; it stands in, with little
  /// weight, where the view shows nothing or something well behind. Null where there is none.
  /// Reuses memory. `sensor`: its noise decides which depths belong to one surface.
  void assign(const ModelView& view, const DepthSensor& sensor, const FrameLevel* fill = nullptr);
  const ModelPoints& level(int i) const { return levels_[i]; }

 private:
  std::array<ModelPoints, kLevels> levels_;
  std::array<ModelPlanes, kLevels> planes_;
};

}  // namespace pf

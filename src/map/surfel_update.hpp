// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "posefusion/core/noise.hpp"
#include "posefusion/core/rigid_motion.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// Weight of a measurement: 1 / variance, 1 at a distance of 1 m.
inline float measurementWeight(float z) {
  const float ratio = depthSigma(1.0F) / depthSigma(z);
  return std::min(ratio * ratio, 2.0F);
}

/// Radius (m) of the disc that fills a pixel's footprint on a surface seen at this cosine, at most
/// doubled. It reaches to the neighbouring pixels' centres, so that discs overlap and leave no
/// holes.
inline float footprintRadius(float z, float fx, float cosine) {
  return z / fx / std::max(cosine, 0.5F);
}

/// The update of single surfels from one frame. Threads may share it: each call of update() writes
/// surfel i alone, and marks pixels in `explained`.
class SurfelUpdate {
 public:
  /// `nearest_m`: smallest depth around each pixel of the frame. All arguments must outlive this.
  SurfelUpdate(const WorkingFrame& frame, const cv::Mat& nearest_m,
               const Eigen::Isometry3d& T_map_camera, SurfelMap& map,
               std::vector<std::uint8_t>& explained);

  /// True when this frame supports the surfel.
  bool update(std::size_t i) const;

 private:
  float depthOnRay(int u, int v, float ray_x, float ray_y) const;
  void explain(float fu, float fv, float radius_px) const;
  void merge(std::size_t i, const Eigen::Vector3f& p, float measured, int u, int v) const;
  void mergeNormal(std::size_t i, float share, const Eigen::Vector3f& n) const;
  Eigen::Vector3f normal(int u, int v) const;

  const WorkingFrame& frame_;
  const cv::Mat& nearest_m_;
  RigidMotion to_camera_, to_map_;
  SurfelArrays& s_;
  const MapConfig& config_;
  int now_;
  float min_cosine_;
  std::vector<std::uint8_t>& explained_;
  float fx_, fy_, cx_, cy_;
};

}  // namespace pf

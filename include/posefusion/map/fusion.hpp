// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/frame/working_frame.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// What one frame did to the map.
struct FusionCounts {
  std::size_t merged = 0;
  std::size_t inserted = 0;
  std::size_t removed = 0;
};

/// Fuses frames into a map. Keeps its work memory between calls. Not thread safe.
///
/// Seen from the surfels, so that each is changed by exactly one pixel and threads never meet: an
/// active surfel projects to a pixel; if the depth there agrees it moves along the pixel's ray by
/// the running weighted mean (weights 1 / variance of the sensor) and gains confidence; if the
/// frame sees well behind it, that is a violation of free space. Pixels that no surfel explains
/// become new surfels. Seen through too often, or unstable and not supported for long: removed. So
/// a person who was fused by mistake goes away once the room behind is seen.
class Fuser {
 public:
  FusionCounts fuse(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                    SurfelMap& map);

 private:
  cv::Mat nearest_m_;                     // smallest depth of 3x3 pixels
  std::vector<std::uint8_t> explained_;   // per pixel
  std::vector<std::uint32_t> row_start_;  // first new surfel of each row
  std::vector<std::uint8_t> doomed_;      // per surfel
};

/// Removes the surfels for which `doomed` (one flag each) is set, keeping the order of the others.
std::size_t compact(const std::vector<std::uint8_t>& doomed, SurfelArrays& surfels);

}  // namespace pf

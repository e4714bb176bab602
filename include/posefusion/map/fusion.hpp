// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>

#include "posefusion/frame/working_frame.hpp"
#include "posefusion/graph/deformation.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// What is known of a frame beside its pixels and its pose.
struct FusionOptions {
  int fragment = kFirstFragment;  ///< that the pose is in

  /// False while the pose is on probation: nothing then counts against stable surfels.
  bool may_remove_stable = true;

  /// CV_8UC1, size of the input frame, 255 = a person or another moving object; may be empty. A
  /// surfel seen there at the depth of `input_depth_m` was fused from one by mistake: that
  /// contradicts it. What was mapped close by less than 1.5 s ago, and is not seen in this frame,
  /// may be what was mapped of people before they were found: that counts as two such frames.
  cv::Mat mask;
  /// CV_32FC1 (m, 0 = none), size of the mask: the depth before people were taken out. What a
  /// person stands behind is not there: it counts as seen through.
  cv::Mat input_depth_m;

  /// Exposure: grey level of the map = gain * grey level of the frame + offset.
  float gain = 1.0F;
  float offset = 0.0F;
};

/// What one frame did to the map.
struct FusionCounts {
  std::size_t merged = 0;
  std::size_t inserted = 0;
  std::size_t removed = 0;
};

/// Fuses frames into a map. Keeps its work memory between calls, and for 20 s how far frames saw.
/// Not thread safe.
///
/// Seen from the surfels, so that each is changed by exactly one pixel and threads never meet: an
/// active surfel in view projects to a pixel; if the depth there agrees and it does not turn its
/// back, it moves along the pixel's ray by the running weighted mean (weights 1 / variance of the
/// sensor) and its odds rise; if the frame sees well behind it, or something of another colour that
/// is out of range, they fall. Pixels that no surfel explains become new surfels, of lower odds
/// where frames of the last 20 s saw free space. Refuted, or unstable and not supported for long:
/// removed. So a person fused by mistake disappears once the room behind is seen.
class Fuser {
 public:
  Fuser();
  ~Fuser();

  /// Throws InputError when the images of the options do not have the size of the input frame.
  FusionCounts fuse(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                    SurfelMap& map, const FusionOptions& options = {});

  /// The map was corrected: what frames saw moves with it.
  void follow(const Deformation& deformation);

  /// Another map begins.
  void forget();

 private:
  struct Scratch;
  void update(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
              const FusionOptions& options, SurfelMap& map, FusionCounts& counts);
  std::size_t clean(SurfelMap& map);

  std::unique_ptr<Scratch> scratch_;
};

}  // namespace pf

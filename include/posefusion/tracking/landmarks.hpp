// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/pace.hpp"
#include "posefusion/frame/flow.hpp"

namespace pf {

/// The depth of a frame, and what took it.
struct DepthPicture {
  const cv::Mat& depth_m;  ///< CV_32FC1, 0 = invalid
  const PinholeCamera& camera;
  DepthSensor sensor{};
  Pace pace{};
};

/// What lies around a corner.
struct CornerDepth {
  double z_m = 0;        ///< of the surface, at the corner; 0: no depth, or not on one surface
  bool is_edge = false;  ///< there is depth, but of more than one surface
};

/// The surface around a pixel, which may be inclined. Some holes are allowed: dark and bright
/// things return little. `depth_m`: CV_32FC1, 0 = invalid.
CornerDepth depthAround(const cv::Mat& depth_m, const DepthSensor& sensor,
                        const cv::Point2f& pixel);

/// A corner of the world in space, for as long as it is followed.
struct Landmark {
  std::uint32_t id = 0;                          ///< of the corner, see SparseFlow
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< m, map frame: mean of what was seen
  double weight = 0;                             ///< 1 / variance of the depth, summed up
  float misses = 0;                              ///< frames (at 30 Hz) that saw it elsewhere

  bool isBelieved() const;
};

/// The corners that are followed now, placed in the map by the poses of the frames that saw them.
/// They tie each motion to the map: motion measured from one frame to the next alone drifts several
/// times faster. A corner on a moving person leaves its place and is detected.
class Landmarks {
 public:
  /// Null when the corner is new.
  const Landmark* find(std::uint32_t id) const;

  /// Takes in where a frame at a known pose sees its corners; corners no longer followed are
  /// forgotten. Known landmarks move only by frames whose pose is `believed`.
  void update(const SparseFlow& flow, const DepthPicture& seen,
              const Eigen::Isometry3d& T_map_camera, bool believed);

  /// Follows a correction of the map frame.
  void move(const Eigen::Isometry3d& T_new_old);

  void clear() { landmarks_.clear(); }

 private:
  std::vector<Landmark> landmarks_, next_;  // by rising number
};

}  // namespace pf

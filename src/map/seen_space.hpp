// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/rigid_motion.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/graph/deformation.hpp"

namespace pf {

/// How far frames of the last 20 s saw, in cells of 4 x 4 pixels: what stands where they saw to
/// what lies well behind has come there since. Follows corrections of the map. (After the
/// ever-free space of L. Schmid et al., "Dynablox", RA-L 2023, of views in place of voxels: these
/// need no grid that a correction would bend.)
class SeenSpace {
 public:
  /// Remembers a fused frame, if the last one was some time ago. `free_m`: CV_32FC1, size of the
  /// working frame, free up to there (m), 0: not known.
  void add(const cv::Mat& free_m, const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
           int fragment, std::int32_t map_frame);

  /// Moves what frames saw with the map.
  void follow(const Deformation& deformation);

  void clear() { views_.clear(); }

  /// The remembered views as seen from a camera, to ask of many of its points.
  class FromCamera {
   public:
    /// Whether two views saw well past a point of the camera (m), by more than `behind_m`. Any
    /// thread.
    bool wasFree(float x, float y, float z, float behind_m) const;

   private:
    friend class SeenSpace;
    struct Seen {
      RigidMotion T_view_camera;
      float fx, fy, cx, cy;  // of cells
      cv::Mat free_m;        // that of the view
    };
    std::vector<Seen> views_;
  };
  FromCamera from(const Eigen::Isometry3d& T_map_camera, int fragment) const;

 private:
  struct View {
    cv::Mat free_m;  // CV_32FC1, of cells: all of a cell is free up to there; 0: not known
    PinholeCamera camera;
    Eigen::Isometry3d T_map_camera;
    int fragment;
    std::int32_t map_frame;
  };
  std::deque<View> views_;  // oldest first
};

}  // namespace pf

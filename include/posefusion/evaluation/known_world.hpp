// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <unordered_set>
#include <vector>

#include "posefusion/core/frame.hpp"

namespace pf {

/// What the frames of a recording that were located have truly seen, by their true poses: whatever
/// the map made of it. Decides whether a lost camera sees a place that it should know.
class KnownWorld {
 public:
  /// A view of less than so much with depth, people left out, is covered.
  static constexpr double kOpen = 0.15;
  /// A view of which so much was seen before should be known.
  static constexpr double kKnown = 0.6;

  struct View {
    double open = 0;   ///< part of the pixels with depth (0 to 5 m) beside people
    double known = 0;  ///< part of those in a voxel (0.1 m) that was seen before

    bool shouldBeKnown() const { return open >= kOpen && known >= kKnown; }
  };

  /// An undistorted frame, its true mask of people (CV_8UC1, 0 = no person; may be empty) and its
  /// true pose. Nothing is learnt yet.
  View look(const RgbdFrame& frame, const cv::Mat& mask, const Eigen::Isometry3d& T_world_camera);

  /// The frame that look() was called with last was located: what it saw is known from now on.
  void learn();

 private:
  std::unordered_set<std::uint64_t> known_;
  std::vector<std::uint64_t> seen_;  ///< voxels of the last frame, one for each pixel
  cv::Mat depth_m_;
};

}  // namespace pf

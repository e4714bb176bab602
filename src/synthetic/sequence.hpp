// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>

#include "posefusion/core/frame.hpp"
#include "posefusion/core/trajectory.hpp"
#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// What the code-made sequence shows. Room and camera path depend on the seed alone, so that a run
/// with and one without the figure see the same.
struct SyntheticOptions {
  int frames = 150;  ///< at 30 Hz
  bool figure = true;
  bool noise = true;  ///< sensor noise in colour and depth, a few pixels of noise in the joints
  std::uint32_t seed = 1;
  int width = 640;  ///< pixels; the field of view stays
  int height = 480;
};

/// One frame with its exact truth.
struct SyntheticFrame {
  RgbdFrame frame;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  cv::Mat true_depth;  ///< CV_32FC1, metres along the optical axis, figure included, no noise
  cv::Mat mask;        ///< CV_8UC1, 255 = the figure
  People people;       ///< joints of the figure as a good detector would report them
};

/// A short hand-held RGB-D recording of a furnished room in which one person walks, made by ray
/// casting. The map frame is the camera frame of frame 0. Same options, same bytes, in any order of
/// calls and for any number of threads. frame() may be called from several threads.
class SyntheticSequence {
 public:
  explicit SyntheticSequence(const SyntheticOptions& options);
  ~SyntheticSequence();

  int frameCount() const;
  const PinholeCamera& camera() const;

  /// Index in [0, frameCount()).
  SyntheticFrame frame(int index) const;

  Eigen::Isometry3d pose(int index) const;  ///< T_map_camera of frame(index), without rendering
  std::int64_t stamp(int index) const;      ///< nanoseconds
  Trajectory truth() const;

  /// Upward direction (against gravity) in the map frame, unit length.
  Eigen::Vector3d up() const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace pf

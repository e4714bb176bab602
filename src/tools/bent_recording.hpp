// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <random>
#include <string>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/frame/working_frame.hpp"

namespace pf {

/// A frame, and where it is in the bent map.
struct TrueFrame {
  WorkingFrame frame;
  WorkingFrame through_gap;  ///< most of it covered, as by people near the camera
  WorkingFrame repainted;    ///< with the picture of another place: a room of the same shape
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  bool is_masked = true;  ///< people are taken out
};

struct BendOptions {
  double shift_m = 0.02, turn_rad = 0.009, period_s = 25.0;
};

/// What drift adds to the poses of a map: slow, and never far.
class Bend {
 public:
  Bend(const BendOptions& options, std::mt19937& chance);
  Eigen::Isometry3d at(double seconds) const;

 private:
  BendOptions options_;
  std::array<double, 6> phases_{};
};

/// A recording with true poses and masks, frame by frame, with the poses that a bent map has of it.
class BentRecording {
 public:
  /// Throws InputError where there are no true poses.
  BentRecording(const std::string& sequence, const BendOptions& bend, std::mt19937& chance);

  std::size_t size() const { return frames_; }

  /// Calls `use(index, frame)` for the frames of which `isWanted(index)`.
  void forEach(const std::function<bool(std::size_t)>& isWanted,
               const std::function<void(std::size_t, const TrueFrame&)>& use);

  /// People stay in some of the frames from now on: a detector misses them.
  void missSome() { all_masked_ = false; }

 private:
  void prepare(RgbdFrame& frame, TrueFrame& out);
  cv::Mat maskOf(std::int64_t stamp_ns, bool& is_masked);
  void leaveGap(cv::Mat& depth);
  void repaint(RgbdFrame& frame, const Eigen::Isometry3d& T_map_camera);

  std::string sequence_;
  std::mt19937& chance_;
  Bend bend_;
  Trajectory truth_;
  std::size_t frames_;
  cv::Mat color_, other_color_;  ///< of about here, and of where the camera was before
  Eigen::Isometry3d T_seen_ = Eigen::Isometry3d::Identity();
  bool all_masked_ = true;
};

}  // namespace pf

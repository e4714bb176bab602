// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

namespace pf {

/// What became of one frame of a recording with a fall, and what is true of it.
struct FallFrame {
  std::int64_t stamp_ns = 0;
  bool tracking = false, lost = false;  ///< state of the tracker after it
  bool has_pose = false;
  bool blurred = false;  ///< too much to see anything
  double overlap = 0;    ///< of its view with the map; see ViewOverlap
  // Of its pose, where it has one.
  double error_m = 0, error_rad = 0;  ///< in the map, which may itself be off
  double from_truth_m = 0;

  void setError(const Eigen::Isometry3d& T_true_pose);
  bool isWrong() const;  ///< from 0.10 m or 5 degrees on
};

/// One loss, until the next.
struct Loss {
  std::optional<std::int64_t> seen_ns;   ///< first sharp view that the map covers
  std::optional<std::int64_t> found_ns;  ///< first frame in state `tracking`

  /// From that view to that frame, 0 where it was sooner; nothing where it was not found, or the
  /// map was never in view.
  std::optional<double> seconds() const;
};

/// How a camera came back after it was lost in a fall.
struct FallReturn {
  bool was_lost = false;
  /// The slowest way back, of several losses; since the beginning of the fall where the tracker
  /// held on through it.
  Loss slowest;
  /// Frames that overlap the map, and of them those with a pose: counted from there, and once the
  /// camera is up again.
  struct Known {
    std::size_t frames = 0, posed = 0;
  } since_loss, once_up;
  std::size_t wrong = 0;          ///< poses since the fall that are wrong
  double worst_from_truth_m = 0;  ///< of all poses since the fall

  /// Of the slowest; 0 where it was never lost.
  std::optional<double> seconds() const;
};

constexpr double kCoveredOverlap = 0.8;  ///< a view that a camera should be found by
constexpr double kKnownOverlap = 0.6;    ///< a view that a camera should have a pose in

/// `frames`: from the beginning of a fall to that of the next, or to the end. Time counts from the
/// tracker's own loss, so that what the camera sees while it lies and gets up counts too. `up_ns`:
/// when it is up again.
FallReturn checkReturn(const std::vector<FallFrame>& frames, std::int64_t up_ns);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// A frame and the map as it is after it.
struct MappedView {
  std::int64_t stamp_ns = 0;
  const cv::Mat& depth_m;  ///< CV_32FC1, 0 = invalid
  const PinholeCamera& camera;
  Eigen::Isometry3d T_world_camera;  ///< true
  Eigen::Isometry3d T_map_world;     ///< as the map has the surroundings of the camera
  const SurfelMap& map;
};

/// The surface of a thing at a place where it stood or came to stand, and what a map has there,
/// frame by frame: whether an old place is forgotten once it is seen empty, or a new one mapped
/// once it is seen. Not thread safe.
class PlaceWatch {
 public:
  enum class Kind { left, taken };

  /// `points`: of the surface, world (m), without those that something else lies near.
  PlaceWatch(Kind kind, std::vector<Eigen::Vector3d> points);

  /// In the order of time: for a place that was left, from just before on, for one that was taken,
  /// from then on.
  void add(const MappedView& view);

  /// How many points the map knew when watching began (left), or were seen by now (taken).
  std::size_t known() const;
  /// Since when so much of the place was seen empty (left: half of what was known) or taken (15 %
  /// of the points, 30 or more) that the map could show it.
  std::optional<std::int64_t> seenAt() const { return seen_ns_; }
  /// When the map showed it: a tenth or less of what was known is left, or half of what was seen is
  /// there. Not before seenAt().
  std::optional<std::int64_t> toldAt() const { return told_ns_; }
  /// Of the time from seenAt() to toldAt(), or to the last frame, how long the place was in view
  /// (s): each frame's time counts by the part that it shows of what the map had wrong.
  double inViewS() const { return in_view_s_; }
  /// The part of the known points near which the map has a stable surfel, now.
  double mapped() const;

 private:
  void look(const MappedView& view);
  void findSurfels(const MappedView& view);
  bool isSeen() const;
  /// The part of what the map has wrong that the newest frame shows.
  double shownOfWrong() const;

  Kind kind_;
  std::vector<Eigen::Vector3d> points_;
  /// Of each point; shown: seen empty, or taken, by any frame, and by the newest.
  std::vector<char> known_, shown_, shown_now_, mapped_;
  bool begun_ = false;
  double in_view_s_ = 0;
  std::int64_t last_ns_ = 0;
  std::optional<std::int64_t> seen_ns_, told_ns_;
};

}  // namespace pf

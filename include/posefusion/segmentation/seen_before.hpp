// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <vector>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/frame/model_view.hpp"
#include "posefusion/segmentation/background.hpp"
#include "posefusion/segmentation/grid.hpp"

namespace pf {

/// Depth grids of some frames of the last second, which show whether a place seen now was empty
/// then. Unlike the map they also know free space with nothing mapped behind it, and each is of one
/// moment. Not thread safe.
class SeenBefore {
 public:
  /// Ages of the moments compared: fast motion shows soon, slow motion later.
  static constexpr std::array<double, 3> kAges_s = {0.2, 0.5, 1.0};

  /// Takes in a frame's grid. `camera`: of the frame. know() gives its pose later.
  void add(const SceneGrid& grid, const PinholeCamera& camera, std::int64_t stamp_ns);

  /// A view gives the pose of the frame with the same stamp. In another fragment all is forgotten.
  void know(const ModelView& view);

  /// What each moment shows of `cells` of a frame at `stamp_ns`, seen from T_uncorrected_camera:
  /// `nearer` = the place was seen to be empty, `agrees` = the same surface was there, `farther` =
  /// something was in front of it. Other cells, and where there is no such moment all, are unknown.
  void compare(const SceneGrid& grid, const std::vector<int>& cells,
               const Eigen::Isometry3d& T_uncorrected_camera, std::int64_t stamp_ns,
               const DepthSensor& sensor);

  /// By moment, cell by cell; as of the last compare().
  const std::array<std::vector<Background>, kAges_s.size()>& moments() const { return moments_; }

  bool wasFree(int cell) const { return said(cell, Background::nearer); }
  bool wasThere(int cell) const { return said(cell, Background::agrees); }
  /// The same surface was there at the oldest moment, and none since speaks against it.
  bool stood(int cell) const {
    return moments_.back()[static_cast<std::size_t>(cell)] == Background::agrees && !wasFree(cell);
  }

  void reset() { *this = SeenBefore(); }

 private:
  struct Moment {
    ModelView view;  ///< depth, uncorrected pose and stamp alone
    bool is_located = false;
  };

  bool said(int cell, Background what) const;
  const Moment* nearestTo(std::int64_t stamp_ns) const;

  std::deque<Moment> kept_;  // by stamp
  int fragment_ = kFirstFragment;
  std::array<std::vector<Background>, kAges_s.size()> moments_;
};

}  // namespace pf

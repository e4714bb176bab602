// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "posefusion/calibration/view_surface.hpp"

namespace pf {

/// Two views that saw the same surface.
struct ViewPair {
  std::size_t from = 0, to = 0;  ///< places in the list of surfaces, from < to
  Eigen::Isometry3d T_to_from = Eigen::Isometry3d::Identity();
  double overlap = 0;  ///< part of the patches of the one that lie on a surface of the other
};

/// What makes two views a pair.
struct PairLimits {
  double least_overlap = 0.2;      ///< less leaves the pose of a pair too free
  std::size_t most_per_view = 24;  ///< pairs with later views, spread evenly over them
  std::size_t most_pairs = 2000;   ///< spread over all views: seconds of work, and enough
  double most_apart_m = 0.25;      ///< surfaces further apart than this are two
};

/// All pairs with enough overlap, ordered by `from` and `to`: neighbours and those that a loop
/// brought together alike.
std::vector<ViewPair> overlappingPairs(const std::vector<ViewSurface>& surfaces,
                                       const PairLimits& limits = {});

}  // namespace pf

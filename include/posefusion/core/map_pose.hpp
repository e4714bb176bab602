// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace pf {

/// The map consists of fragments, numbered from 0: pieces each of which is known to hang together,
/// while how they lie to each other is not known. Each has coordinates of its own. The first holds
/// the map's origin; a camera that is lost for long begins another, which a loop joins to an older
/// one. "The map frame" without more is that of the fragment spoken of.
constexpr int kFirstFragment = 0;

/// A camera somewhere in the map.
struct MapPose {
  int fragment = kFirstFragment;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();  ///< map frame of the fragment
};

}  // namespace pf

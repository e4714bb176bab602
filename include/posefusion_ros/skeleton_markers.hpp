// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include "posefusion/core/frame.hpp"
#include "posefusion/pose/skeleton.hpp"

namespace posefusion_ros {

/// Skeletons in the camera's optical frame: a line per limb whose two joints were seen and have
/// depth. Joints whose depth is far from that of most of the person's (the background's), and
/// bones longer than people have them, are left out. Begins with a marker that deletes those of the
/// frame before.
visualization_msgs::MarkerArray toMarkers(const pf::People& people, const pf::RgbdFrame& frame,
                                          const std_msgs::Header& header);

/// Takes away what was shown before.
visualization_msgs::MarkerArray noMarkers(const std_msgs::Header& header);

}  // namespace posefusion_ros

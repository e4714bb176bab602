// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <vector>

#include "posefusion/segmentation/moving_object.hpp"
#include "posefusion_ros/bags/messages.hpp"

namespace posefusion_ros {

/// `header`: stamp of the frame, and the frame that the objects are in.
MovingObjectsMsg toMessage(const std::vector<pf::MovingObject>& objects,
                           const std_msgs::Header& header);

/// For each object its box (people and others in two colours), its number, and where it will be in
/// half a second as an arrow, if it is not at rest. Begins with a marker that deletes those of the
/// frame before.
visualization_msgs::MarkerArray toMarkers(const std::vector<pf::MovingObject>& objects,
                                          const std_msgs::Header& header);

}  // namespace posefusion_ros

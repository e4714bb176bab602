// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/Pose.h>
#include <std_msgs/Header.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "posefusion/frame/flow.hpp"
#include "posefusion/pose/skeleton.hpp"
#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/bags/messages.hpp"

namespace posefusion_ros {

// What the stages say to each other and to users, as messages.

PeopleMsg toMessage(const pf::People& people, const std_msgs::Header& header);
/// The mask is a view of the message's bytes.
pf::People fromMessage(const PeopleMsg& message);

/// `header` is that of the later frame's colour image.
SparseFlowMsg::Ptr toMessage(const pf::SparseFlow& flow, const std_msgs::Header& header);
/// Throws InputError when it is not one of ours.
pf::SparseFlow fromMessage(const SparseFlowMsg& message);

/// `header` has the stamp of the frame and the map frame; `T_map_camera` is the camera's in that
/// frame.
TrackingStatusMsg toMessage(const pf::FrameStatus& status, const std_msgs::Header& header,
                            const Eigen::Isometry3d& T_map_camera);

/// Outcome, state, pose (in the map frame of the message) and times; the rest is not in a message.
pf::FrameStatus fromMessage(const TrackingStatusMsg& message);

/// "fused", "blurred", "dropped": an outcome of TrackingStatusMsg as one word.
std::string outcomeName(std::uint8_t outcome);

geometry_msgs::Pose toPose(const Eigen::Isometry3d& T);

}  // namespace posefusion_ros

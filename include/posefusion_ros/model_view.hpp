// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>

#include "posefusion/frame/model_view.hpp"
#include "posefusion_ros/bags/messages.hpp"

namespace posefusion_ros {

/// A copy of those of the view's planes that the segmenter reads: depth and stable. `header` has
/// the stamp of the frame after which the view holds.
ModelViewMsg::Ptr toMessage(const pf::ModelView& view, const std_msgs::Header& header);

/// The view on the message's bytes: the message must live as long as it. Empty where there is no
/// map, or while tracking is lost. Throws InputError when the message is not one of ours.
pf::ModelView fromMessage(const ModelViewMsg::ConstPtr& message);

}  // namespace posefusion_ros

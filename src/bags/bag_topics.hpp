// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>

#include <map>
#include <string>

#include "posefusion_ros/bags/bag_source.hpp"

namespace posefusion_ros {

/// Name and type of each topic.
using TopicTypes = std::map<std::string, std::string>;

TopicTypes topicsOf(const rosbag::Bag& bag);

/// Fills in the topics that are not given. `people` and `truth` stay empty when there are none, and
/// `camera_info` too. Throws InputError that lists what the bag has when colour or depth cannot be
/// identified or a given topic is not there or of the wrong type.
BagTopics chooseTopics(const TopicTypes& available, const BagTopics& given);

}  // namespace posefusion_ros

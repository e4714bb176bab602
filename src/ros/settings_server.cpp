// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/settings_server.hpp"

#include <ros/console.h>

#include <exception>

namespace posefusion_ros {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigDescription;
using dynamic_reconfigure::Reconfigure;

SettingsTopics::SettingsTopics(const ros::NodeHandle& handle, VisitSettings visit, Change change)
    : handle_(handle), visit_(std::move(visit)), change_(std::move(change)) {
  descriptions_ = handle_.advertise<ConfigDescription>("parameter_descriptions", 1, true);
  updates_ = handle_.advertise<Config>("parameter_updates", 1, true);
  descriptions_.publish(describe(visit_));
  updates_.publish(valuesOf(visit_));
  service_ = handle_.advertiseService("set_parameters", &SettingsTopics::onSet, this);
}

bool SettingsTopics::onSet(Reconfigure::Request& request, Reconfigure::Response& response) {
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    change_(request.config);
  } catch (const std::exception& error) {
    ROS_ERROR("%s: nothing is changed: %s", handle_.getNamespace().c_str(), error.what());
    return false;
  }
  remember(request.config);
  response.config = valuesOf(visit_);
  updates_.publish(response.config);
  return true;
}

/// On the parameter server, as dynamic_reconfigure does it.
void SettingsTopics::remember(const Config& values) {
  for (const auto& each : values.bools) handle_.setParam(each.name, each.value != 0);
  for (const auto& each : values.ints) handle_.setParam(each.name, each.value);
  for (const auto& each : values.doubles) handle_.setParam(each.name, each.value);
  for (const auto& each : values.strs) handle_.setParam(each.name, each.value);
}

}  // namespace posefusion_ros

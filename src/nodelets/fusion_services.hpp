// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <posefusion/LoadMap.h>
#include <posefusion/SetMode.h>
#include <ros/node_handle.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "posefusion_ros/mapping_session.hpp"

namespace posefusion_ros {

/// What is asked of fusion by services, carried out between two frames.
class FusionServices {
 public:
  /// Runs a task between two frames.
  using Post = std::function<std::future<void>(std::function<void()>)>;

  /// `handle`: private, of a queue that no work waits for. `shows_another`: called between two
  /// frames after the map was exchanged for another.
  FusionServices(ros::NodeHandle& handle, MappingSession& session, Post post,
                 std::function<void()> shows_another);

  /// No more calls.
  void shutdown();

  /// Frames are not to be looked at. Thread safe.
  bool isPaused() const { return is_paused_; }

 private:
  using Trigger = std_srvs::Trigger;
  using LoadMap = posefusion::LoadMap;
  using SetMode = posefusion::SetMode;

  bool onSave(Trigger::Request& request, Trigger::Response& response);
  bool onReset(Trigger::Request& request, Trigger::Response& response);
  bool onLoad(LoadMap::Request& request, LoadMap::Response& response);
  bool onSetMode(SetMode::Request& request, SetMode::Response& response);
  bool onPause(Trigger::Request& request, Trigger::Response& response);
  bool onResume(Trigger::Request& request, Trigger::Response& response);

  template <typename Response>
  bool answer(const std::function<std::string()>& task, Response& response);

  MappingSession& session_;
  Post post_;
  std::function<void()> shows_another_;
  std::atomic<bool> is_paused_{false};
  std::vector<ros::ServiceServer> services_;
};

}  // namespace posefusion_ros

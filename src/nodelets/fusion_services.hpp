// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <posefusion/LoadMap.h>
#include <posefusion/SetMode.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "posefusion_ros/map_query.hpp"
#include "posefusion_ros/mapping_session.hpp"
#include "posefusion_ros/running_settings.hpp"
#include "posefusion_ros/settings_server.hpp"

namespace posefusion_ros {

/// What is asked of fusion by services and by dynamic_reconfigure, carried out between two frames.
class FusionServices {
 public:
  struct Actions {
    MapQuery::Post post;                  ///< runs a task between two frames
    std::function<void()> shows_another;  ///< the map was exchanged for another
    MapQuery::Draw draw;
    std::function<void(const FusionSettings&)> apply;
  };

  /// `handle`: private, of a queue that no work waits for. All but `post` are called between two
  /// frames.
  FusionServices(ros::NodeHandle& handle, MappingSession& session, Actions actions,
                 const FusionSettings& initial);

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
  bool onCalibrate(Trigger::Request& request, Trigger::Response& response);
  bool onSaveMesh(Trigger::Request& request, Trigger::Response& response);
  bool onLoad(LoadMap::Request& request, LoadMap::Response& response);
  bool onSetMode(SetMode::Request& request, SetMode::Response& response);
  bool onPause(Trigger::Request& request, Trigger::Response& response);
  bool onResume(Trigger::Request& request, Trigger::Response& response);

  template <typename Response>
  bool answer(const std::function<std::string()>& task, Response& response);
  template <typename Response>
  static bool tell(const Response& response);

  MappingSession& session_;
  Actions actions_;
  std::atomic<bool> is_paused_{false}, is_ending_{false};
  // Whoever waits for frames to come, or works for long, must not hold a thread of the manager:
  // frames may wait for it.
  ros::CallbackQueue waiting_;
  std::vector<ros::ServiceServer> services_;
  ros::AsyncSpinner waiter_{2, &waiting_};
  std::unique_ptr<MapQuery> map_query_;
  std::unique_ptr<SettingsServer<FusionSettings>> settings_;
};

}  // namespace posefusion_ros

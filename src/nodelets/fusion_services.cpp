// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_services.hpp"

#include <ros/console.h>
#include <tbb/task_arena.h>

#include <optional>
#include <thread>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/map/stable_surfels.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"
#include "posefusion_ros/calibration_wait.hpp"
#include "posefusion_ros/trigger.hpp"

namespace posefusion_ros {

FusionServices::FusionServices(ros::NodeHandle& handle, MappingSession& session, Actions actions,
                               const FusionSettings& initial)
    : session_(session), actions_(std::move(actions)) {
  services_ = {handle.advertiseService("save_map", &FusionServices::onSave, this),
               handle.advertiseService("load_map", &FusionServices::onLoad, this),
               handle.advertiseService("set_mode", &FusionServices::onSetMode, this),
               handle.advertiseService("pause", &FusionServices::onPause, this),
               handle.advertiseService("resume", &FusionServices::onResume, this),
               handle.advertiseService("reset", &FusionServices::onReset, this)};
  ros::NodeHandle waiting(handle);
  waiting.setCallbackQueue(&waiting_);
  services_.push_back(waiting.advertiseService("calibrate", &FusionServices::onCalibrate, this));
  services_.push_back(waiting.advertiseService("save_mesh", &FusionServices::onSaveMesh, this));
  waiter_.start();
  map_query_ = std::make_unique<MapQuery>(handle, actions_.post, actions_.draw);
  settings_ = std::make_unique<SettingsServer<FusionSettings>>(
      handle, initial,
      [post = actions_.post, apply = actions_.apply](const FusionSettings& changed) {
        post([&] { apply(changed); }).get();
      });
}

void FusionServices::shutdown() {
  is_ending_ = true;  // for calls that wait for frames
  for (ros::ServiceServer& service : services_) service.shutdown();
  waiter_.stop();
  settings_.reset();
  map_query_.reset();
}

bool FusionServices::onSave(Trigger::Request& /*request*/, Trigger::Response& response) {
  return answer([this] { return session_.save(); }, response);
}

bool FusionServices::onReset(Trigger::Request& /*request*/, Trigger::Response& response) {
  const auto task = [this] {
    std::string said = session_.reset();
    actions_.shows_another();
    return said;
  };
  return answer(task, response);
}

bool FusionServices::onLoad(LoadMap::Request& request, LoadMap::Response& response) {
  std::string file;
  pf::SavedMap map;
  try {  // the chain goes on while the file is read
    file = session_.saver().resolve(request.file);
    map = pf::readSavedMap(file);
  } catch (const std::exception& error) {
    response.message = error.what();
    ROS_ERROR("%s", error.what());
    return true;
  }
  const auto task = [&] {
    std::string said = session_.load(file, std::move(map));
    actions_.shows_another();
    return said;
  };
  return answer(task, response);
}

bool FusionServices::onSetMode(SetMode::Request& request, SetMode::Response& response) {
  const auto task = [&] {
    if (request.mode == "mapping") return session_.setUse(pf::MapUse::extend);
    for (const char* name : {"localisation", "localization", "localize_only"}) {
      if (request.mode == name) return session_.setUse(pf::MapUse::localize_only);
    }
    throw pf::InputError("mode '" + request.mode +
                         "', expected mapping or localisation (localization, localize_only)");
  };
  return answer(task, response);
}

bool FusionServices::onPause(Trigger::Request& /*request*/, Trigger::Response& response) {
  const auto task = [this] {
    is_paused_ = true;
    return std::string("paused: frames are reported and not looked at");
  };
  return answer(task, response);
}

bool FusionServices::onResume(Trigger::Request& /*request*/, Trigger::Response& response) {
  const auto task = [this] {
    is_paused_ = false;
    return std::string("frames are looked at");
  };
  return answer(task, response);
}

bool FusionServices::onCalibrate(Trigger::Request& /*request*/, Trigger::Response& response) {
  CalibrationWait wait;
  const auto ask = [&] {
    if (is_paused_) throw pf::InputError("paused: frames are not looked at");
    session_.askForCalibration();
    wait = CalibrationWait(session_.calibrationProgress());
    return std::string();
  };
  const auto look = [&] { return wait.look(session_.calibrationProgress()); };
  answerTrigger(actions_.post, ask, response);
  while (response.success != 0U && response.message.empty() && !is_ending_) {
    std::this_thread::sleep_for(CalibrationWait::kPeriod);
    answerTrigger(actions_.post, look, response);
  }
  if (response.message.empty()) {
    response.success = 0U;
    response.message = "shutting down";
  }
  return tell(response);
}

/// Between two frames the map is copied alone, which shares its surfels.
bool FusionServices::onSaveMesh(Trigger::Request& /*request*/, Trigger::Response& response) {
  std::optional<pf::SurfelMap> map;
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();
  const auto copy = [&] {
    map = session_.mapper().map();
    T_world_map = session_.mapper().worldFromMap();
    return std::string();
  };
  answerTrigger(actions_.post, copy, response);
  if (response.success == 0U) return tell(response);
  try {
    const pf::SurfelArrays surfels = pf::stableSurfels(*map, T_world_map);
    map.reset();
    tbb::task_arena alone(1);  // the threads that parallel loops share belong to the frames
    alone.execute(
        [&] { response.message = session_.saver().saveMesh(pf::surfelMesh(surfels, {})); });
  } catch (const std::exception& error) {
    response.success = 0U;
    response.message = error.what();
  }
  return tell(response);
}

template <typename Response>
bool FusionServices::answer(const std::function<std::string()>& task, Response& response) {
  answerTrigger(actions_.post, task, response);
  return tell(response);
}

template <typename Response>
bool FusionServices::tell(const Response& response) {
  if (response.success) {
    ROS_INFO("%s", response.message.c_str());
  } else {
    ROS_ERROR("%s", response.message.c_str());
  }
  return true;
}

}  // namespace posefusion_ros

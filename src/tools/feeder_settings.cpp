// SPDX-License-Identifier: BSD-3-Clause
#include "feeder_settings.hpp"

#include <ros/console.h>

#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

FeederSettings readFeederSettings() {
  Parameters parameters{ros::NodeHandle("~")};
  FeederSettings s;
  s.lossless = parameters.flag("lossless", s.lossless);
  s.window = parameters.integer("window", s.window, {1, 1000});
  s.rate = parameters.number("rate", s.rate, {1e-3, 1e3});
  s.timeout_s = parameters.number("timeout_s", s.timeout_s, {0.1, 1e6});
  s.max_frames = parameters.integer("max_frames", s.max_frames, {0, 1e9});
  s.tf = parameters.flag("tf", s.tf);
  s.clock = parameters.flag("clock", s.clock);
  s.frame_id = parameters.text("frame_id", "");
  s.input.camera_file = parameters.text("camera_file", "");
  s.input.topics.color = parameters.text("color_topic", "");
  s.input.topics.depth = parameters.text("depth_topic", "");
  s.input.topics.camera_info = parameters.text("camera_info_topic", "");
  s.input.topics.depth_camera_info = parameters.text("depth_camera_info_topic", "");
  s.input.depth_stamp_offset_s = parameters.number("depth_stamp_offset_s", 0.0, {-10.0, 10.0});
  s.manager = parameters.text("manager", "");
  std::istringstream ends(parameters.text("ends", ""));
  for (std::string name; ends >> name;) s.ends.push_back(name);
  s.stays = parameters.text("stays", "");
  s.output = parameters.text("output", "");
  try {
    s.config = parameters.config({});
  } catch (const pf::InputError&) {
    // They are those of the chain, which does not start with them and says why.
  }
  for (const std::string& name : parameters.unknown()) {
    ROS_WARN("unknown parameter %s: it has no effect", name.c_str());
  }
  return s;
}

}  // namespace posefusion_ros

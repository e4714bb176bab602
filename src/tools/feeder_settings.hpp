// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/slam/config.hpp"
#include "posefusion_ros/bags/bag_source.hpp"

namespace posefusion_ros {

/// What posefusion_feeder does; see docs/ros-api.md.
struct FeederSettings {
  bool lossless = true;
  int window = 2;
  double rate = 1.0;
  double timeout_s = 60.0;
  int max_frames = 0;
  bool tf = false;
  bool clock = true;     ///< publish /clock
  std::string frame_id;  ///< of the images; empty: the bag's
  std::string
      manager;  ///< node of the chain: the replay fails where it is gone; empty: not looked for
  std::vector<std::string>
      ends;            ///< nodes that are ended after the last frame, in this order; may be empty
  std::string stays;   ///< node that is waited for then (rviz); may be empty
  std::string output;  ///< of fusion: a summary is written there at the end; empty: none
  pf::Config config;   ///< for the summary
  InputOptions input;
};

/// From the private parameters. Throws InputError naming the one that is wrong.
FeederSettings readFeederSettings();

}  // namespace posefusion_ros

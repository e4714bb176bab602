// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "posefusion/slam/config.hpp"
#include "posefusion_ros/bags/bag_source.hpp"

namespace pf {

/// What the user asks of posefusion_run.
struct RunOptions {
  std::string input;
  std::string output = "output";
  std::string truth;  ///< empty: that of the input
  posefusion_ros::InputOptions reading;
  std::string imu, odometry;   ///< files of the robot's other sensors; empty: none
  std::string calibration;     ///< file that depth is corrected by; empty: none
  std::size_t max_frames = 0;  ///< 0: all
  int threads = 0;             ///< 0: all cores
  bool save_masks = false;
  bool check_depth = false;
  std::string map_file;        ///< to begin in; empty: a new map
  bool localize_only = false;  ///< in it
  bool continue_map = false;   ///< write that file on
  std::string status_file;     ///< table of what became of each frame; empty: none
  std::string mesh_file;       ///< mesh of the map to write; empty: none
  bool view = false;           ///< write a page that turns the map in a browser
  Config config;
};

/// Reads the command line (a file of settings, then the mode, then single options and settings, the
/// later over the earlier) and runs `run` where there is something to run. Returns the exit code of
/// the program: see runTool().
int runWithOptions(int argc, char** argv, const std::function<int(const RunOptions&)>& run);

}  // namespace pf

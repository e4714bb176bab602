// SPDX-License-Identifier: BSD-3-Clause
#include "run_options.hpp"

#include <iostream>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/mesh_file.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr std::size_t kMostFrames = 1'000'000'000;
constexpr int kMostThreads = 1024;

/// Options that end up in the configuration.
struct ConfigOptions {
  std::string file, mode, model, detector;
  std::vector<std::string> assignments;
};

Config makeConfig(const ConfigOptions& given) {
  Config config;
  if (!given.file.empty()) applyFile(config, given.file);
  if (!given.mode.empty()) applyMode(config, given.mode);
  if (!given.model.empty()) config.pose.model = given.model;
  if (!given.detector.empty()) config.pose.detector = given.detector;
  for (const auto& assignment : given.assignments) applyAssignment(config, assignment);
  return config;
}

void addTopicOptions(CommandLine& app, posefusion_ros::InputOptions& reading) {
  auto& topics = reading.topics;
  app.addOption("--color-topic", topics.color, "bag: colour images")->group("Bags");
  app.addOption("--depth-topic", topics.depth, "bag: registered depth images")->group("Bags");
  app.addOption("--camera-info-topic", topics.camera_info, "bag: the camera")->group("Bags");
  app.addOption("--depth-camera-info-topic", topics.depth_camera_info,
                "bag: the camera of depth, where its images have another size")
      ->group("Bags");
  app.addOption("--depth-stamp-offset-s", reading.depth_stamp_offset_s,
                "bag: added to the stamps of depth before they are compared with those of colour")
      ->group("Bags")
      ->check(range(-10.0, 10.0));
  app.addOption("--people-topic", topics.people, "bag: recorded People")->group("Bags");
  app.addOption("--truth-topic", topics.truth, "bag: true camera poses")->group("Bags");
  app.addOption("--max-pair-difference", reading.max_pair_difference_s,
                "bag: seconds between the stamps of colour and depth")
      ->check(positive())
      ->group("Bags");
}

/// Throws before the run, not after it, where the mesh cannot be written.
void requireMeshFile(const std::string& path) {
  requireMeshName(path);
  AtomicFile probe(path);
}

}  // namespace

int runWithOptions(int argc, char** argv, const std::function<int(const RunOptions&)>& run) {
  CommandLine app{"Camera trajectory and dense map without the people, from a recorded sequence.",
                  "posefusion_run"};
  RunOptions options;
  ConfigOptions config;
  bool print_config = false;
  auto& reading = options.reading;
  app.addOption("input", options.input, "TUM folder or bag");
  app.addOption("--config", config.file, "YAML file of settings");
  app.addOption("--set", config.assignments, "one setting, group.name=value; may be repeated");
  app.addOption("--mode", config.mode, "elastic, posefusion or pfh");
  app.addOption("--model", config.model, "weights of a pose network");
  app.addOption("--detector", config.detector, "where people come from")
      ->check(oneOf({"auto", "embedded", "network", "network+embedded", "recorded", "none"}));
  app.addOption("--output", options.output,
                "where each run makes a folder of its own for its results; latest leads to it");
  app.addOption("--max-frames", options.max_frames, "stop after so many frames; 0: all")
      ->check(range<std::size_t>(0, kMostFrames));
  app.addOption("--threads", options.threads, "threads to use; 0: all cores")
      ->check(range(0, kMostThreads));
  app.addOption("--truth", options.truth, "true trajectory, TUM format");
  app.addOption("--camera", reading.camera_file, "camera file, instead of the input's own");
  app.addOption("--calibration", options.calibration,
                "file of posefusion_calibrate: the depth of each frame is corrected by it");
  app.addOption("--odometry", options.odometry,
                "the robot's odometry, TUM format: see docs/robot.md");
  app.addOption("--imu", options.imu, "its inertial sensor, EuRoC format");
  auto* map = app.addOption("--map", options.map_file,
                            "map file (*.pfdb) to begin in: the camera is looked for there");
  auto* localize = app.addFlag("--localize-only", options.localize_only,
                               "do not change the map, only find the camera in it");
  app.addFlag("--continue", options.continue_map, "write the map file on")
      ->needs(map)
      ->excludes(localize);
  localize->needs(map);
  addTopicOptions(app, reading);
  app.addFlag("--save-masks", options.save_masks,
              "write mask/, people.json and moving_objects.json");
  app.addOption("--save-status", options.status_file,
                "CSV to write: state, reason, pose and covariance of each frame");
  app.addOption("--mesh", options.mesh_file,
                "mesh of the map to write, *.ply, *.obj or *.glb (posefusion_map mesh has more)");
  app.addFlag("--view", options.view,
              "write view.html, a page that turns the map in a browser (posefusion_map view)");
  app.addFlag("--check-depth", options.check_depth,
              "compare each frame's depth with the map rendered from its pose (slower)");
  app.addFlag("--print-config", print_config, "print all settings and stop");
  return runTool(app, argc, argv, [&] {
    options.config = makeConfig(config);
    if (print_config) {
      std::cout << toYaml(options.config);
      return 0;
    }
    if (options.input.empty()) {
      throw InputError("INPUT is missing: a TUM folder or a bag (see --help)");
    }
    if (!options.mesh_file.empty()) requireMeshFile(options.mesh_file);
    return run(options);
  });
}

}  // namespace pf

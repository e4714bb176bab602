// SPDX-License-Identifier: BSD-3-Clause
#include "run_options.hpp"

#include <charconv>
#include <iostream>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/mesh_file.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr long kMostFrames = 1'000'000'000, kMostThreads = 1024;

/// Accepts 0 to `most`, and says so otherwise (a negative number would wrap around).
CLI::Validator wholeNumber(long most) {
  const std::string range = "0 to " + std::to_string(most);
  return CLI::Validator(
      [most, range](const std::string& text) {
        long value = -1;
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, value);
        const bool is_number = error == std::errc() && stop == end;
        return is_number && value >= 0 && value <= most
                   ? std::string()
                   : "'" + text + "': expected a whole number, " + range;
      },
      range);
}

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

void addTopicOptions(CLI::App& app, posefusion_ros::InputOptions& reading) {
  auto& topics = reading.topics;
  app.add_option("--color-topic", topics.color, "bag: colour images")->group("Bags");
  app.add_option("--depth-topic", topics.depth, "bag: registered depth images")->group("Bags");
  app.add_option("--camera-info-topic", topics.camera_info, "bag: the camera")->group("Bags");
  app.add_option("--depth-camera-info-topic", topics.depth_camera_info,
                 "bag: the camera of depth, where its images have another size")
      ->group("Bags");
  app.add_option("--depth-stamp-offset-s", reading.depth_stamp_offset_s,
                 "bag: added to the stamps of depth before they are compared with those of colour")
      ->group("Bags")
      ->check(CLI::Range(-10.0, 10.0));
  app.add_option("--people-topic", topics.people, "bag: recorded People")->group("Bags");
  app.add_option("--truth-topic", topics.truth, "bag: true camera poses")->group("Bags");
  app.add_option("--max-pair-difference", reading.max_pair_difference_s,
                 "bag: seconds between the stamps of colour and depth")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group("Bags");
}

/// Throws before the run, not after it, where the mesh cannot be written.
void requireMeshFile(const std::string& path) {
  requireMeshName(path);
  AtomicFile probe(path);
}

}  // namespace

int runWithOptions(int argc, char** argv, const std::function<int(const RunOptions&)>& run) {
  CLI::App app{"Camera trajectory and dense map without the people, from a recorded sequence.",
               "posefusion_run"};
  RunOptions options;
  ConfigOptions config;
  bool print_config = false;
  auto& reading = options.reading;
  app.add_option("input", options.input, "TUM folder or bag");
  app.add_option("--config", config.file, "YAML file of settings");
  app.add_option("--set", config.assignments, "one setting, group.name=value; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--mode", config.mode, "elastic, posefusion or pfh");
  app.add_option("--model", config.model, "weights of a pose network");
  app.add_option("--detector", config.detector, "where people come from")
      ->check(
          CLI::IsMember({"auto", "embedded", "network", "network+embedded", "recorded", "none"}));
  app.add_option("--output", options.output,
                 "where each run makes a folder of its own for its results; latest leads to it")
      ->capture_default_str();
  app.add_option("--max-frames", options.max_frames, "stop after so many frames; 0: all")
      ->check(wholeNumber(kMostFrames));
  app.add_option("--threads", options.threads, "threads to use; 0: all cores")
      ->check(wholeNumber(kMostThreads));
  app.add_option("--truth", options.truth, "true trajectory, TUM format");
  app.add_option("--camera", reading.camera_file, "camera file, instead of the input's own");
  app.add_option("--calibration", options.calibration,
                 "file of posefusion_calibrate: the depth of each frame is corrected by it");
  app.add_option("--odometry", options.odometry,
                 "the robot's odometry, TUM format: see docs/robot.md");
  app.add_option("--imu", options.imu, "its inertial sensor, EuRoC format");
  auto* map = app.add_option("--map", options.map_file,
                             "map file (*.pfdb) to begin in: the camera is looked for there");
  auto* localize = app.add_flag("--localize-only", options.localize_only,
                                "do not change the map, only find the camera in it");
  app.add_flag("--continue", options.continue_map, "write the map file on")
      ->needs(map)
      ->excludes(localize);
  localize->needs(map);
  addTopicOptions(app, reading);
  app.add_flag("--save-masks", options.save_masks, "write mask/ and people.json");
  app.add_option("--save-status", options.status_file,
                 "CSV to write: state, reason, pose and covariance of each frame");
  app.add_option("--mesh", options.mesh_file,
                 "mesh of the map to write, *.ply, *.obj or *.glb (posefusion_map mesh has more)");
  app.add_flag("--check-depth", options.check_depth,
               "compare each frame's depth with the map rendered from its pose (slower)");
  app.add_flag("--print-config", print_config, "print all settings and stop");
  return runTool(app, argc, argv, [&] {
    options.config = makeConfig(config);
    if (print_config) {
      std::cout << toYaml(options.config);
      return 0;
    }
    if (options.input.empty()) {
      throw InputError("INPUT is missing: a TUM folder or a bag (--help tells more)");
    }
    if (!options.mesh_file.empty()) requireMeshFile(options.mesh_file);
    return run(options);
  });
}

}  // namespace pf

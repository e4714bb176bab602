// SPDX-License-Identifier: BSD-3-Clause
// posefusion_launch_check: looks at what a launch file was given, before anything is started.
// Called by roslaunch for the value of a parameter: roslaunch ends with 1 where this fails, and has
// no other way to end so. Says what is wrong on stderr.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/run_folder.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/pose/detector.hpp"
#include "posefusion/pose/model_settings.hpp"
#include "posefusion/slam/config.hpp"
#include "posefusion_ros/bags/bag_source.hpp"
#include "posefusion_ros/input_settings.hpp"
#include "posefusion_ros/node_control.hpp"

namespace {

namespace fs = std::filesystem;
using pf::InputError;

constexpr char kAssign[] = ":=";

/// "name:=value" as a pair; an empty name for anything else.
std::pair<std::string, std::string> split(const std::string& text) {
  const auto at = text.find(kAssign);
  if (at == std::string::npos) return {};
  return {text.substr(0, at), text.substr(at + 2)};
}

std::vector<std::string> declaredArguments(const std::string& launch_file) {
  const std::string text = pf::readFile(launch_file);
  const std::regex declaration("<arg\\s+name=\"(\\w+)\"");
  std::vector<std::string> names;
  for (std::sregex_iterator i(text.begin(), text.end(), declaration), end; i != end; ++i) {
    names.push_back((*i)[1]);
  }
  return names;
}

/// roslaunch itself ignores arguments that a launch file does not have. Only where this launch file
/// is the one that was called: otherwise the arguments are those of another one. `included` is one
/// that takes all its arguments; may be empty.
void checkArguments(const std::string& launch_file, const std::string& included) {
  const std::string called = fs::path(launch_file).filename().string();
  const std::vector<std::string> words = posefusion_ros::parentCommand();
  int files = 0;
  for (const auto& word : words) {
    const fs::path path(word);
    if (path.extension() != ".launch" && path.extension() != ".xml") continue;
    ++files;
    if (path.filename() != called) return;
  }
  if (files != 1) return;
  std::vector<std::string> names = declaredArguments(launch_file);
  if (!included.empty()) {
    for (const auto& name : declaredArguments(included)) names.push_back(name);
  }
  for (const auto& word : words) {
    const std::string name = split(word).first;
    if (name.empty() || name.front() == '_') continue;  // __log:=, _private:=
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    std::string known;
    for (const auto& each : names) known += " " + each;
    throw InputError("argument " + name + " is unknown, expected one of" + known);
  }
}

/// What the launch file says about itself.
class Given {
 public:
  Given(int argc, char** argv) {
    for (int i = 2; i < argc; ++i) values_.insert(split(argv[i]));
  }

  std::string operator[](const std::string& name) const {
    const auto found = values_.find(name);
    return found == values_.end() ? "" : found->second;
  }

  /// Those named, with blanks between them, have to be true or false.
  void checkFlags(const std::string& names) const {
    std::istringstream list(names);
    for (std::string name; list >> name;) {
      const std::string value = (*this)[name];
      if (value == "true" || value == "false" || value == "1" || value == "0") continue;
      throw InputError("argument " + name + ":=" + value + ", expected true or false");
    }
  }

 private:
  std::map<std::string, std::string> values_;
};

pf::Config configOf(const Given& given) {
  pf::Config config;
  pf::applyFile(config, given["config"]);
  if (!given["mode"].empty()) pf::applyMode(config, given["mode"]);
  if (!given["model"].empty()) config.pose.model = given["model"];
  if (!given["detector"].empty()) pf::applyAssignment(config, "pose.detector=" + given["detector"]);
  return config;
}

/// A large network takes seconds to load: where there is a file, the nodelet finds out.
void checkDetector(const pf::PoseConfig& config) {
  const std::string detector = pf::chosenDetector(config);
  if (detector == "embedded") pf::makePoseDetector(config, {});
  if (detector != "network" && detector != "network+embedded") return;
  const std::string model = config.model.empty() ? pf::defaultModelPath() : config.model;
  if (!fs::exists(model)) pf::makePoseDetector(config, {});
  pf::findModelSettings(model);
}

/// The camera of the map file that is begun in; nothing where there is none.
std::optional<pf::PinholeCamera> checkMap(const Given& given) {
  const auto isSet = [&](const std::string& name) {
    return given[name] == "true" || given[name] == "1";
  };
  if (isSet("localize_only") && isSet("continue_map")) {
    throw InputError("arguments localize_only and continue_map: expected one of them");
  }
  if (!given["map"].empty()) return pf::readSavedMap(given["map"]).camera;
  if (isSet("localize_only") || isSet("continue_map")) {
    throw InputError("arguments localize_only and continue_map need a map:=FILE");
  }
  return std::nullopt;
}

/// Its file is there and can be read. Where it is one of ours that is missing, the others are
/// named.
void checkCamera(const Given& given) {
  const fs::path file = given["camera_settings"];
  if (file.empty()) return;
  if (!fs::exists(file) && file.stem() == given["camera"] && fs::exists(file.parent_path())) {
    std::set<std::string> known;
    for (const auto& entry : fs::directory_iterator(file.parent_path())) {
      if (entry.path().extension() == ".yaml") known.insert(entry.path().stem());
    }
    std::string list;
    for (const auto& name : known) list += " " + name;
    throw InputError("argument camera:=" + given["camera"] + ", expected one of" + list +
                     ", or a file of your own (camera_settings:=FILE)");
  }
  XmlRpc::XmlRpcValue values;
  for (const char* name :
       {"camera_settings", "image_transport", "depth_image_transport", "depth_stamp_offset_s"}) {
    if (!given[name].empty()) values[name] = given[name];
  }
  posefusion_ros::Parameters parameters(values, "slam.launch");
  posefusion_ros::readInput(parameters);
}

void checkCalibration(const Given& given) {
  const std::string file = given["calibration"];
  if (!file.empty()) pf::loadCalibration(file);
}

void checkInput(const Given& given, const pf::Config& config,
                const std::optional<pf::PinholeCamera>& of_map) {
  posefusion_ros::InputOptions options;
  options.camera_file = given["camera_file"];
  options.topics.color = given["color_topic"];
  options.topics.depth = given["depth_topic"];
  options.topics.camera_info = given["camera_info_topic"];
  options.topics.depth_camera_info = given["depth_camera_info_topic"];
  const std::string bag = given["bag"];
  const auto source = posefusion_ros::openInput(bag, options);
  if (config.pose.detector == "recorded" && source->people().empty()) {
    throw InputError("detector:=recorded: " + bag +
                     " has no recorded people, expected people.json or a topic of them");
  }
  if (!of_map) return;
  const std::string defect = pf::cameraDefect(given["map"], *of_map, *source, bag);
  if (!defect.empty()) throw InputError(defect);
}

void check(const std::string& launch_file, const Given& given) {
  checkArguments(launch_file, given["includes"]);
  given.checkFlags(given["flags"]);
  const pf::Config config = configOf(given);
  if (given["without_people_if_no_detector"] != "true") checkDetector(config.pose);
  checkCalibration(given);
  checkCamera(given);
  const auto of_map = checkMap(given);
  if (!given["bag"].empty()) checkInput(given, config, of_map);
  if (!given["output"].empty()) pf::RunFolder(given["output"]).removeIfEmpty();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: posefusion_launch_check LAUNCH_FILE [name:=value]...\n";
    return 2;
  }
  const std::string launch_file = argv[1];
  try {
    check(launch_file, Given(argc, argv));
    std::cout << "ok";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "\n"
              << fs::path(launch_file).filename().string() << ": " << error.what() << "\n\n";
    return 1;
  }
}

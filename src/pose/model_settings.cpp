// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/model_settings.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "package_folders.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

int jointNamed(const std::string& name) {
  const auto found = std::find(kJointNames.begin(), kJointNames.end(), name);
  return found == kJointNames.end() ? -1 : static_cast<int>(found - kJointNames.begin());
}

void readInput(const YAML::Node& root, ModelSettings& settings) {
  settings.prototxt = root["prototxt"].as<std::string>("");
  const YAML::Node input = root["input"];
  if (!input) throw InputError("input: missing");
  settings.input_height_px = input["height"].as<int>();
  settings.input_multiple_px = input["multiple"].as<int>(16);
  settings.scale = input["scale"].as<double>();
  settings.mean = input["mean"].as<std::array<double, 3>>();
  const auto order = input["channel_order"].as<std::string>();
  if (order != "bgr" && order != "rgb") {
    throw InputError("input.channel_order: '" + order + "', expected bgr or rgb");
  }
  settings.bgr = order == "bgr";
  if (settings.input_height_px < 1 || settings.input_multiple_px < 1) {
    throw InputError("input: height and multiple must be positive");
  }
}

void readParts(const YAML::Node& output, ModelSettings& settings) {
  settings.stride = output["stride"].as<int>();
  if (settings.stride < 1) throw InputError("output.stride: must be positive");
  for (const auto& entry : output["parts"]) {
    const auto name = entry.first.as<std::string>();
    settings.parts.push_back({name, entry.second.as<int>(), jointNamed(name)});
  }
  if (settings.parts.empty()) throw InputError("output.parts: missing");
}

int partNamed(const ModelSettings& settings, const std::string& name) {
  for (std::size_t i = 0; i < settings.parts.size(); ++i) {
    if (settings.parts[i].name == name) return static_cast<int>(i);
  }
  throw InputError("output.limbs: no part is named '" + name + "'");
}

void readLimbs(const YAML::Node& output, ModelSettings& settings) {
  for (const YAML::Node& limb : output["limbs"]) {
    if (limb.size() != 4) {
      throw InputError("output.limbs: expected [from, to, channel x, channel y]");
    }
    settings.limbs.push_back({partNamed(settings, limb[0].as<std::string>()),
                              partNamed(settings, limb[1].as<std::string>()), limb[2].as<int>(),
                              limb[3].as<int>()});
  }
  if (settings.limbs.empty()) throw InputError("output.limbs: missing");
}

std::vector<fs::path> packageConfigFolders() {
  std::vector<fs::path> folders;
  const char* override_folder = std::getenv("POSEFUSION_CONFIG_DIR");
  if (override_folder != nullptr && *override_folder != '\0') folders.emplace_back(override_folder);
  for (const fs::path& folder : packageFolders("config")) folders.push_back(folder);
  return folders;
}

}  // namespace

ModelSettings loadModelSettings(const std::string& path) {
  try {
    const YAML::Node root = YAML::LoadFile(path);
    const YAML::Node output = root["output"];
    if (!output) throw InputError("output: missing");
    ModelSettings settings;
    readInput(root, settings);
    readParts(output, settings);
    readLimbs(output, settings);
    return settings;
  } catch (const std::exception& error) {
    throw InputError(path + ": not the settings of a pose network: " + error.what());
  }
}

std::string findModelSettings(const std::string& model_path) {
  fs::path beside(model_path);
  beside.replace_extension(".yaml");
  if (fs::exists(beside)) return beside.string();
  std::string searched = beside.string();
  for (const fs::path& folder : packageConfigFolders()) {
    const fs::path candidate = folder / "models" / beside.filename();
    if (fs::exists(candidate)) return candidate.string();
    searched += ", " + candidate.string();
  }
  throw InputError("pose.model: no settings for " + model_path + "; looked for " + searched +
                   ". Models from scripts/get_models have theirs; for another network write one "
                   "after the examples in config/models");
}

std::string defaultModelPath() {
  const char* data = std::getenv("XDG_DATA_HOME");
  const char* home = std::getenv("HOME");
  fs::path folder;
  if (data != nullptr && *data != '\0') {
    folder = data;
  } else {
    folder = fs::path(home != nullptr ? home : ".") / ".local" / "share";
  }
  return (folder / "posefusion" / "models" / "tf_pose_mobilenet_v2_small.opencv.pb").string();
}

}  // namespace pf

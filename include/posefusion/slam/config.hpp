// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "posefusion/blur/config.hpp"
#include "posefusion/calibration/config.hpp"
#include "posefusion/config/fields.hpp"
#include "posefusion/frame/config.hpp"
#include "posefusion/frame/sensor_config.hpp"
#include "posefusion/graph/config.hpp"
#include "posefusion/loop/config.hpp"
#include "posefusion/map/config.hpp"
#include "posefusion/pose/config.hpp"
#include "posefusion/robot/config.hpp"
#include "posefusion/segmentation/config.hpp"
#include "posefusion/tracking/config.hpp"

namespace YAML {
class Node;
}

namespace pf {

/// Every setting of the chain, one struct per stage. A default-made Config is the shipped default;
/// config/posefusion.yaml restates it and a test keeps the two equal.
struct Config {
  BlurConfig blur;
  PoseConfig pose;
  SegmentationConfig segmentation;
  SensorConfig sensor;
  FrameConfig frame;
  TrackingConfig tracking;
  RobotConfig robot;
  MapConfig map;
  LoopConfig loop;
  GraphConfig graph;
  CalibrationConfig calibration;
};

/// The depth camera of the settings. Throws InputError as depthSensorOf() does.
inline DepthSensor depthSensorOf(const Config& config) {
  return depthSensorOf(config.sensor, config.frame);
}

/// Lists all fields in order, grouped by stage.
void visitFields(Config& config, FieldVisitor& visitor);

/// Sets the fields named by a YAML map of maps (`tracking: {max_distance_m: 0.1}`). Throws
/// InputError naming the key for an unknown key, a value of another type or out of its limits.
/// `origin` (a file, a parameter namespace) goes into the message.
void applyYaml(Config& config, const YAML::Node& node, const std::string& origin);

/// Reads a file over `config`. Throws InputError naming the file.
void applyFile(Config& config, const std::string& path);

/// Sets one field from text: "tracking.max_distance_m=0.1". Throws InputError naming the key.
void applyAssignment(Config& config, const std::string& assignment);

/// Modes differ by configuration alone: "elastic" (no people removal, no gate), "posefusion"
/// (people removal only), "pfh" (all). Throws InputError for another name.
void applyMode(Config& config, const std::string& mode);

/// The whole configuration as commented YAML.
std::string toYaml(const Config& config);

/// Key and value of every field, in order, as text.
std::vector<std::pair<std::string, std::string>> listFields(const Config& config);

}  // namespace pf

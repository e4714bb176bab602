// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/config/fields.hpp"
#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/frame/config.hpp"

namespace pf {

/// The kind that means "what the recording says, else structured light".
constexpr const char* kAnySensor = "auto";

/// Settings of the depth camera: which kind it is and, where more is known of it, its own numbers.
struct SensorConfig {
  std::string kind = kAnySensor;
  double axial_sigma_m = 0;
  double axial_growth_1_m = 0;
  double axial_growth_from_m = 0;
  double lateral_sigma_rad = 0;
  double depth_step_1_m = 0;
  double systematic_m = 0;
  double systematic_1_m = 0;
};

/// "structured_light", "time_of_flight", "active_stereo".
const std::vector<std::string>& sensorKinds();

void visitFields(SensorConfig& config, FieldVisitor& visitor);

/// Throws InputError for a kind that is none of sensorKinds() nor kAnySensor.
DepthSensor depthSensorOf(const SensorConfig& sensor, const FrameConfig& frame);

}  // namespace pf

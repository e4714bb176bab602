// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/frame/sensor_config.hpp"

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

// The numbers of each kind and where they come from: docs/sensor.md.

/// Kinect v2, Azure Kinect. Fankhauser et al. 2015: 1.5 - 0.5 z + 0.3 z^2 mm, the square completed;
/// what is systematic by the makers of the Azure Kinect.
DepthSensor timeOfFlight() {
  DepthSensor sensor;
  sensor.kind = DepthSensorKind::time_of_flight;
  sensor.axial_m = 0.00129F;
  sensor.axial_1_m = 0.0003F;
  sensor.axial_from_m = 0.83F;
  sensor.lateral_rad = 0.0014;
  sensor.step_1_m = 0.0F;
  sensor.systematic_m = 0.011F;
  sensor.systematic_1_m = 0.0F;
  return sensor;
}

/// RealSense D435 at 848 x 480: 50 mm apart, focal length 425 pixels, disparity to 0.08 pixels in
/// steps of 1/32, depth within 2 % at 2 m.
DepthSensor activeStereo() {
  DepthSensor sensor;
  sensor.kind = DepthSensorKind::active_stereo;
  sensor.axial_m = 0.001F;
  sensor.axial_1_m = 0.0038F;
  sensor.axial_from_m = 0.0F;
  sensor.lateral_rad = 0.0035;
  sensor.step_1_m = 0.0015F;
  sensor.systematic_m = 0.0F;
  sensor.systematic_1_m = 0.01F;
  return sensor;
}

DepthSensor sensorOfKind(const std::string& kind) {
  const auto& kinds = sensorKinds();
  if (kind == kAnySensor || kind == kinds[0]) return {};
  if (kind == kinds[1]) return timeOfFlight();
  if (kind == kinds[2]) return activeStereo();
  throw InputError("sensor.kind is '" + kind + "', expected " + kAnySensor + ", " + kinds[0] +
                   ", " + kinds[1] + " or " + kinds[2]);
}

template <typename Number>
void take(double given, Number& number) {
  if (given > 0) number = static_cast<Number>(given);
}

}  // namespace

const std::vector<std::string>& sensorKinds() {
  static const std::vector<std::string> kinds = {"structured_light", "time_of_flight",
                                                 "active_stereo"};
  return kinds;
}

void visitFields(SensorConfig& c, FieldVisitor& v) {
  v.choice("kind", c.kind, {kAnySensor, sensorKinds()[0], sensorKinds()[1], sensorKinds()[2]},
           "how the depth camera measures, which gives its errors (docs/sensor.md); auto: what a "
           "recording's camera file says, else structured_light, a Kinect 1 or Xtion");
  v.number("axial_sigma_m", c.axial_sigma_m, 0.0, 1.0,
           "smallest standard deviation of depth; this and the next numbers: 0 = that of the kind");
  v.number("axial_growth_1_m", c.axial_growth_1_m, 0.0, 1.0,
           "added to it: this times the square of what depth is more than axial_growth_from_m");
  v.number("axial_growth_from_m", c.axial_growth_from_m, 0.0, 10.0, "see axial_growth_1_m");
  v.number("lateral_sigma_rad", c.lateral_sigma_rad, 0.0, 0.1,
           "standard deviation of the direction that depth is of");
  v.number("depth_step_1_m", c.depth_step_1_m, 0.0, 1.0,
           "step of inverse depth: 1 / (focal length in pixels x baseline x steps a pixel)");
  v.number("systematic_m", c.systematic_m, 0.0, 1.0,
           "error of depth that does not average out, the same at any distance");
  v.number("systematic_1_m", c.systematic_1_m, 0.0, 1.0,
           "the same of inverse depth; with a calibration what is left, about 0.0004");
}

DepthSensor depthSensorOf(const SensorConfig& config, const FrameConfig& frame) {
  DepthSensor sensor = sensorOfKind(config.kind);
  take(config.axial_sigma_m, sensor.axial_m);
  take(config.axial_growth_1_m, sensor.axial_1_m);
  take(config.axial_growth_from_m, sensor.axial_from_m);
  take(config.lateral_sigma_rad, sensor.lateral_rad);
  take(config.depth_step_1_m, sensor.step_1_m);
  take(config.systematic_m, sensor.systematic_m);
  take(config.systematic_1_m, sensor.systematic_1_m);
  sensor.min_depth_m = frame.min_depth_m;
  sensor.max_depth_m = frame.max_depth_m;
  return sensor;
}

}  // namespace pf

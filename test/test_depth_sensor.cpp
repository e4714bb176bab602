// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/depth_sensor.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/slam/config.hpp"

namespace pf {
namespace {

DepthSensor sensorOf(const std::string& kind) {
  Config config;
  config.sensor.kind = kind;
  return depthSensorOf(config);
}

/// Equation (3) of Nguyen, Izadi and Lovell 2012 without its angular term.
double nguyen(double z_m) { return 0.0012 + 0.0019 * (z_m - 0.4) * (z_m - 0.4); }

/// Fankhauser et al. 2015, seen straight on.
double fankhauser(double z_m) { return 1e-3 * (1.5 - 0.5 * z_m + 0.3 * z_m * z_m); }

TEST(DepthSensor, TheDefaultIsAKinect) {
  for (const DepthSensor& sensor :
       {DepthSensor{}, sensorOf("auto"), sensorOf("structured_light")}) {
    EXPECT_EQ(sensor.kind, DepthSensorKind::structured_light);
    for (double z = 0.4; z < 10.0; z += 0.1) {
      const auto depth = static_cast<float>(z);
      EXPECT_NEAR(sensor.sigma(depth), nguyen(z), 1e-6);
      // Of what is systematic no more than the noise covers: the tolerances are those of the noise.
      for (const float sigmas : {3.0F, 4.0F, 5.0F}) {
        EXPECT_EQ(sensor.tolerance(depth, sigmas), 0.01F + sigmas * sensor.sigma(depth)) << z;
      }
    }
  }
}

TEST(DepthSensor, NoiseAndTolerancesRiseWithDepth) {
  for (const std::string& kind : sensorKinds()) {
    const DepthSensor sensor = sensorOf(kind);
    for (float z = 1.0F; z < 15.0F; z += 0.1F) {
      EXPECT_GT(sensor.sigma(z), 0.0F);
      EXPECT_LT(sensor.sigma(z), sensor.sigma(z + 0.1F)) << kind << " at " << z;
      EXPECT_LE(sensor.tolerance(z, 5.0F), sensor.tolerance(z + 0.1F, 5.0F)) << kind << z;
      EXPECT_LE(sensor.tolerance(z, 3.0F), sensor.tolerance(z, 5.0F)) << kind << z;
    }
  }
}

TEST(DepthSensor, TimeOfFlightIsAsMeasured) {
  const DepthSensor sensor = sensorOf("time_of_flight");
  EXPECT_EQ(sensor.kind, DepthSensorKind::time_of_flight);
  for (double z = 0.5; z < 5.0; z += 0.1) {
    EXPECT_NEAR(sensor.sigma(static_cast<float>(z)), fankhauser(z), 3e-5);
  }
  // Two places that are each 11 mm off do not fall out of tolerance, though the noise is 2 mm.
  EXPECT_GT(sensor.tolerance(2.0F, 5.0F), 0.01F + 0.011F * std::sqrt(2.0F) - 1e-4F);
}

TEST(DepthSensor, StereoIsCoarserFarAway) {
  const DepthSensor stereo = sensorOf("active_stereo"), kinect, flight = sensorOf("time_of_flight");
  EXPECT_EQ(stereo.kind, DepthSensorKind::active_stereo);
  EXPECT_GT(stereo.tolerance(5.0F, 5.0F), 1.5F * kinect.tolerance(5.0F, 5.0F));
  EXPECT_LT(flight.tolerance(5.0F, 5.0F), 0.5F * kinect.tolerance(5.0F, 5.0F));
  // By disparity: with the square of depth.
  EXPECT_NEAR(stereo.sigma(8.0F) / stereo.sigma(4.0F), 4.0, 0.1);
}

TEST(DepthSensor, SettingsOverruleTheKind) {
  Config config;
  applyAssignment(config, "sensor.kind=active_stereo");
  applyAssignment(config, "sensor.axial_growth_1_m=0.0013");
  applyAssignment(config, "sensor.systematic_1_m=0.0004");
  applyAssignment(config, "frame.max_depth_m=9");
  const DepthSensor sensor = depthSensorOf(config), kind = sensorOf("active_stereo");
  EXPECT_EQ(sensor.axial_1_m, 0.0013F);
  EXPECT_EQ(sensor.systematic_1_m, 0.0004F);
  EXPECT_EQ(sensor.axial_m, kind.axial_m);
  EXPECT_EQ(sensor.lateral_rad, kind.lateral_rad);
  EXPECT_EQ(sensor.max_depth_m, 9.0);
  EXPECT_LT(sensor.tolerance(4.0F, 3.0F), kind.tolerance(4.0F, 3.0F));
}

TEST(DepthSensor, SettingsReadBackAsTheSame) {
  Config config, read;
  config.sensor = {"time_of_flight", 0.001, 0.002, 0.3, 0.004, 0.005, 0.006, 0.007};
  applyYaml(read, YAML::Load(toYaml(config)), "test");
  EXPECT_EQ(listFields(read), listFields(config));
  EXPECT_EQ(depthSensorOf(read).systematic_1_m, 0.007F);
}

TEST(DepthSensor, AnUnknownKindIsRefused) {
  const auto expectError = [](const auto& action, const std::string& text) {
    try {
      action();
      ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()), text);
    }
  };
  Config config;
  expectError([&] { applyAssignment(config, "sensor.kind=lidar"); },
              "setting: sensor.kind is 'lidar', expected one of auto, structured_light, "
              "time_of_flight, active_stereo");
  config.sensor.kind = "lidar";
  expectError([&] { depthSensorOf(config); },
              "sensor.kind is 'lidar', expected auto, structured_light, time_of_flight or "
              "active_stereo");
}

}  // namespace
}  // namespace pf

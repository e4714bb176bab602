// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "posefusion/config/fields.hpp"

namespace pf::simulator {

/// The inertial sensor of the camera; noise is that of the cheap ones in depth cameras.
struct ImuConfig {
  double rate_hz = 200.0;
  Eigen::Vector3d camera_m{0.012, 0.031, -0.007};  ///< the camera, in the frame of the IMU
  /// Roll, pitch, yaw of the camera's body (x ahead, y left, z up) in that frame.
  Eigen::Vector3d camera_rpy_rad{0.010, -0.014, 0.006};
  double gyro_noise_rad_s_rthz = 2.4e-4;  ///< white, as a density
  double accel_noise_m_s2_rthz = 2.0e-3;
  double gyro_walk_rad_s2_rthz = 2.0e-5;  ///< of the bias
  double accel_walk_m_s3_rthz = 3.0e-4;
  double gyro_bias_rad_s = 5.0e-3;  ///< sigma of the bias at the beginning
  double accel_bias_m_s2 = 0.03;
  double gyro_full_scale_deg_s = 2000.0;
  double accel_full_scale_g = 16.0;
  double shock = 1.5;         ///< sigma of the body's ringing, times the acceleration above
  double shock_from_g = 4.0;  ///< this one
};

inline void visitFields(ImuConfig& c, FieldVisitor& v) {
  v.number("rate_hz", c.rate_hz, 1.0, 2000.0, "samples a second");
  v.number("gyro_noise_rad_s_rthz", c.gyro_noise_rad_s_rthz, 0.0, 1.0,
           "density of the gyroscope's white noise");
  v.number("accel_noise_m_s2_rthz", c.accel_noise_m_s2_rthz, 0.0, 10.0,
           "density of the accelerometer's white noise");
  v.number("gyro_walk_rad_s2_rthz", c.gyro_walk_rad_s2_rthz, 0.0, 1.0,
           "density of the walk of the gyroscope's bias");
  v.number("accel_walk_m_s3_rthz", c.accel_walk_m_s3_rthz, 0.0, 10.0,
           "density of the walk of the accelerometer's bias");
  v.number("gyro_bias_rad_s", c.gyro_bias_rad_s, 0.0, 10.0, "sigma of its bias at the beginning");
  v.number("accel_bias_m_s2", c.accel_bias_m_s2, 0.0, 10.0, "sigma of its bias at the beginning");
  v.number("gyro_full_scale_deg_s", c.gyro_full_scale_deg_s, 1.0, 1e5,
           "largest rate it can measure");
  v.number("accel_full_scale_g", c.accel_full_scale_g, 1.0, 1e4, "largest force it can measure");
  v.number("shock", c.shock, 0.0, 100.0,
           "sigma of the body's ringing, times the acceleration above shock_from_g");
  v.number("shock_from_g", c.shock_from_g, 0.0, 1e4, "acceleration that the body rings from");
}

}  // namespace pf::simulator

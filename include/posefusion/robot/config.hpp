// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the camera's motion measured by the robot's other sensors. Errors are standard
/// deviations to begin with: they grow by what the images show of them.
struct RobotConfig {
  double odometry_per_m = 0.03;
  double odometry_per_rad = 0.03;
  double odometry_step_m = 0.002;
  double odometry_step_rad = 0.002;
  double odometry_max_gap_s = 0.25;
  double gyro_noise_rad_s = 0.003;
  double gyro_bias_rad_s = 0.005;
  double gyro_full_scale_rad_s = 34.0;
  double imu_max_gap_s = 0.05;
  double free_fall_m_s2 = 4.0;
  double impact_m_s2 = 35.0;
  double after_fall_s = 1.0;
};

inline void visitFields(RobotConfig& c, FieldVisitor& v) {
  v.number("odometry_per_m", c.odometry_per_m, 0.0, 1.0, "error of odometry, m for each m of way");
  v.number("odometry_per_rad", c.odometry_per_rad, 0.0, 1.0, "rad for each rad of turn");
  v.number("odometry_step_m", c.odometry_step_m, 1e-5, 1.0, "error of a step, however short");
  v.number("odometry_step_rad", c.odometry_step_rad, 1e-5, 1.0, "the same of the turn");
  v.number("odometry_max_gap_s", c.odometry_max_gap_s, 0.001, 10.0,
           "longest time between two poses of odometry that is bridged");
  v.number("gyro_noise_rad_s", c.gyro_noise_rad_s, 1e-6, 1.0,
           "noise of the angular rate: rad / s / sqrt(Hz)");
  v.number("gyro_bias_rad_s", c.gyro_bias_rad_s, 1e-6, 1.0,
           "what is left of its bias, which is learned");
  v.number("gyro_full_scale_rad_s", c.gyro_full_scale_rad_s, 0.1, 1000.0,
           "faster turns are not measured");
  v.number("imu_max_gap_s", c.imu_max_gap_s, 0.001, 1.0,
           "longest time between two samples that is bridged");
  v.number("free_fall_m_s2", c.free_fall_m_s2, 0.0, 9.0,
           "less acceleration than this: the robot falls, and its legs do not measure its motion");
  v.number("impact_m_s2", c.impact_m_s2, 12.0, 1000.0, "more than this: it hits something");
  v.number("after_fall_s", c.after_fall_s, 0.0, 60.0, "for this long its legs are not used");
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/robot/imu_track.hpp"

namespace pf {

/// Reads inertial samples in EuRoC's shape: `stamp_ns,wx,wy,wz,ax,ay,az` a line (rad/s, m/s^2), `#`
/// comments. An `imu.yaml` beside the file says how the sensor is mounted (`T_imu_camera`:
/// `position_m`, `quaternion` x y z w); without one its axes are those of the camera's optical
/// frame, along which the samples are given. Throws InputError naming file and line.
std::vector<ImuSample> loadImu(const std::string& path);

/// Reads odometry in the TUM format. A `base_camera.txt` beside the file, in the same format, has
/// the pose of the camera in the frame whose odometry it is: one line where it is fixed, else as it
/// moves. Without one the odometry is the camera's. Poses where the camera's is not known are left
/// out. Throws InputError naming file and line.
Trajectory loadOdometry(const std::string& path);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/camera_path.hpp"
#include "simulator/imu_config.hpp"

namespace pf::simulator {

/// Acceleration of free fall, m/s^2.
constexpr double kGravity_m_s2 = 9.81;

/// What an inertial sensor says of the interval around a moment, in its own frame.
struct ImuSample {
  double time_s = 0.0;                                   ///< the middle of the interval
  Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();  ///< angular rate
  Eigen::Vector3d force_m_s2 = Eigen::Vector3d::Zero();  ///< specific force: at rest 9.81 upwards
};

/// Takes camera coordinates to those of the inertial sensor.
Eigen::Isometry3d imuFromCamera(const ImuConfig& config);

/// Samples from the beginning of the span to its end. Each is the mean over its interval, as
/// sensors integrate: without noise, rates put together give the turn, and forces summed twice the
/// way, exactly. Then white noise, a walking bias, ringing where the body is stopped hard, and
/// full scale.
std::vector<ImuSample> senseImu(const CameraPath& path, const ImuConfig& config,
                                const TimeSpan& span, std::uint32_t seed);

}  // namespace pf::simulator

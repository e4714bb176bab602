// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "posefusion/robot/config.hpp"
#include "posefusion/robot/motion_prior.hpp"

namespace pf {

/// Of an inertial sensor that is rigid to the camera, along the axes of the camera's optical frame.
struct ImuSample {
  std::int64_t stamp_ns = 0;
  Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_m_s2 = Eigen::Vector3d::Zero();  ///< at rest 9.81 upwards
};

/// Samples of an inertial sensor of the last ten seconds. Not thread safe.
class ImuTrack {
 public:
  explicit ImuTrack(const RobotConfig& config) : config_(config) {}

  /// Returns why the sample is left out (not finite, not later than the one before); empty: it is
  /// not.
  std::string add(const ImuSample& sample);

  /// The turn between two moments: the rates, less their bias, integrated. Nothing where samples
  /// are missing, or were beyond what the sensor measures.
  std::optional<MotionPrior> between(std::int64_t from_ns, std::int64_t to_ns) const;

  /// What was felt between two moments, in the axes of the camera as it turned: the mean (m/s^2).
  /// Nothing without samples, and in a fall.
  std::optional<Eigen::Vector3d> feltBetween(std::int64_t from_ns, std::int64_t to_ns) const;

  /// The images have measured this turn: the bias follows, within seconds at first and slowly
  /// later.
  void learnBias(std::int64_t from_ns, std::int64_t to_ns, const Eigen::Matrix3d& R_before_after);

  /// Whether the robot fell or hit something in the last RobotConfig::after_fall_s.
  bool isFalling(std::int64_t now_ns) const;

  const Eigen::Vector3d& bias_rad_s() const { return bias_rad_s_; }

  void clear() { *this = ImuTrack(config_); }

 private:
  using Place = std::deque<ImuSample>::const_iterator;

  /// The samples after a moment, up to another one.
  std::pair<Place, Place> within(std::int64_t from_ns, std::int64_t to_ns) const;
  void watch(const ImuSample& sample);
  std::optional<Eigen::Vector3d> rateAt(std::int64_t stamp_ns) const;
  std::optional<Eigen::Matrix3d> turnBetween(std::int64_t from_ns, std::int64_t to_ns,
                                             const Eigen::Vector3d& bias_rad_s) const;

  RobotConfig config_;
  std::deque<ImuSample> samples_;
  Eigen::Vector3d bias_rad_s_ = Eigen::Vector3d::Zero();
  double learned_s_ = 0;                        ///< that the bias was learned from
  std::optional<std::int64_t> light_since_ns_;  ///< in free fall
  std::optional<std::int64_t> fell_ns_;         ///< when last
};

}  // namespace pf

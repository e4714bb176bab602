// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/imu.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/se3.hpp"
#include "posefusion/core/trajectory.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// Uses of the seed.
enum ImuPurpose : std::uint32_t { kGyro = 1, kAccel, kGyroWalk, kAccelWalk, kShock, kBias };

Vector3d gaussian3(std::uint32_t seed, std::uint32_t index) {
  return {gaussian(hash(seed, index, 0U)), gaussian(hash(seed, index, 1U)),
          gaussian(hash(seed, index, 2U))};
}

/// The exact sample around `t`.
ImuSample exactSample(const CameraPath& path, const Isometry3d& T_camera_imu, double t,
                      double step_s) {
  const auto pose = [&](double at) { return path.at(at) * T_camera_imu; };
  const Isometry3d now = pose(t);
  const Vector3d before = pose(t - step_s).translation(), after = pose(t + step_s).translation();
  const Vector3d acceleration = (after - 2.0 * now.translation() + before) / (step_s * step_s);
  ImuSample sample;
  sample.time_s = t;
  sample.rate_rad_s =
      logSo3(pose(t - 0.5 * step_s).linear().transpose() * pose(t + 0.5 * step_s).linear()) /
      step_s;
  sample.force_m_s2 = now.linear().transpose() * (acceleration + kGravity_m_s2 * Vector3d::UnitZ());
  return sample;
}

Vector3d limited(const Vector3d& value, double most) {
  return value.cwiseMax(-most).cwiseMin(most);
}

/// The errors of one sensor, sample after sample.
class Flaws {
 public:
  Flaws(const ImuConfig& config, std::uint32_t seed) : c_(config), seed_(seed) {
    rate_bias_ = c_.gyro_bias_rad_s * gaussian3(hash(seed_, kBias), 0U);
    force_bias_ = c_.accel_bias_m_s2 * gaussian3(hash(seed_, kBias), 1U);
  }

  void spoil(ImuSample& sample, std::uint32_t index) {
    const double root_hz = std::sqrt(c_.rate_hz);
    const auto luck = [&](ImuPurpose what) { return gaussian3(hash(seed_, what), index); };
    const double hard_m_s2 = sample.force_m_s2.norm() - c_.shock_from_g * kGravity_m_s2;
    const Vector3d ringing = c_.shock * std::max(0.0, hard_m_s2) * luck(kShock);
    sample.rate_rad_s += rate_bias_ + c_.gyro_noise_rad_s_rthz * root_hz * luck(kGyro);
    sample.force_m_s2 += force_bias_ + c_.accel_noise_m_s2_rthz * root_hz * luck(kAccel) + ringing;
    sample.rate_rad_s = limited(sample.rate_rad_s, c_.gyro_full_scale_deg_s * M_PI / 180.0);
    sample.force_m_s2 = limited(sample.force_m_s2, c_.accel_full_scale_g * kGravity_m_s2);
    rate_bias_ += c_.gyro_walk_rad_s2_rthz / root_hz * luck(kGyroWalk);
    force_bias_ += c_.accel_walk_m_s3_rthz / root_hz * luck(kAccelWalk);
  }

 private:
  const ImuConfig& c_;
  std::uint32_t seed_;
  Vector3d rate_bias_, force_bias_;
};

}  // namespace

Isometry3d imuFromCamera(const ImuConfig& config) {
  const Vector3d& rpy = config.camera_rpy_rad;
  Isometry3d T = Isometry3d::Identity();
  T.translate(config.camera_m);
  T.rotate(Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) *
           Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
           Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()));
  T.rotate(bodyFromOptical().linear());
  return T;
}

std::vector<ImuSample> senseImu(const CameraPath& path, const ImuConfig& config,
                                const TimeSpan& span, std::uint32_t seed) {
  const Isometry3d T_camera_imu = imuFromCamera(config).inverse();
  Flaws flaws(config, seed);
  std::vector<ImuSample> samples(momentCount(span, config.rate_hz));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t = span.start_s + static_cast<double>(i) / config.rate_hz;
    samples[i] = exactSample(path, T_camera_imu, t, 1.0 / config.rate_hz);
    flaws.spoil(samples[i], static_cast<std::uint32_t>(i));
  }
  return samples;
}

}  // namespace pf::simulator

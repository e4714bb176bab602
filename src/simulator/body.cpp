// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/body.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/trajectory.hpp"

namespace pf::simulator {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFacing_hz = 20.0;
constexpr int kSmooth = 12;         // moments to either side: a body turns slower than a head
constexpr double kStride_s = 0.75;  // a step to either side, so that swaying is no walking
constexpr double kWalking_m_s = 0.08;
constexpr double kMostYaw_rad = 80.0 * M_PI / 180.0;
constexpr double kMostPitch_rad = 25.0 * M_PI / 180.0;

/// Where a body would face at once: as the camera looks, or where it goes.
class Wish {
 public:
  explicit Wish(const CameraPath& path) : path_(path) {}

  double at(double t) {
    const Vector2d ahead = path_.at(t).linear().col(2).head<2>();
    // A view of the ceiling or of the floor has no heading.
    if (ahead.norm() > 0.3) heading_ = unwrapped(std::atan2(ahead.y(), ahead.x()));
    const Vector3d way =
        path_.at(t + kStride_s).translation() - path_.at(t - kStride_s).translation();
    const Vector2d going = way.head<2>() / (2.0 * kStride_s);
    if (!path_.walks() || going.norm() < kWalking_m_s) return heading_;
    const double aside = std::remainder(std::atan2(going.y(), going.x()) - heading_, 2.0 * M_PI);
    return heading_ + std::clamp(aside, -kMostYaw_rad, kMostYaw_rad);
  }

 private:
  double unwrapped(double angle) const {
    return heading_ + std::remainder(angle - heading_, 2.0 * M_PI);
  }

  const CameraPath& path_;
  double heading_ = 0.0;
};

std::vector<double> smoothed(const std::vector<double>& values) {
  std::vector<double> result(values.size());
  const int count = static_cast<int>(values.size());
  for (int i = 0; i < count; ++i) {
    const int first = std::max(0, i - kSmooth), last = std::min(count - 1, i + kSmooth);
    double sum = 0.0;
    for (int k = first; k <= last; ++k) sum += values[static_cast<std::size_t>(k)];
    result[static_cast<std::size_t>(i)] = sum / (last - first + 1);
  }
  return result;
}

Matrix3d about(double angle_rad, const Vector3d& axis) {
  return AngleAxisd(angle_rad, axis).toRotationMatrix();
}

}  // namespace

Isometry3d baseFromCamera(const LegsConfig& config, const NeckAngles& neck) {
  Isometry3d T = Isometry3d::Identity();
  T.translate(Vector3d(0.0, 0.0, config.neck_m));
  T.rotate(about(neck.yaw_rad, Vector3d::UnitZ()) * about(neck.pitch_rad, Vector3d::UnitY()));
  T.translate(Vector3d(config.eye_m, 0.0, 0.0));
  T.rotate(bodyFromOptical().linear());
  return T;
}

NeckAngles encoded(const LegsConfig& config, const NeckAngles& neck) {
  if (config.encoder_counts == 0) return neck;
  const double step = 2.0 * M_PI / config.encoder_counts;
  return {step * std::round(neck.yaw_rad / step), step * std::round(neck.pitch_rad / step)};
}

double headingOf(const Matrix3d& rotation) { return std::atan2(rotation(1, 0), rotation(0, 0)); }

Body::Body(const CameraPath& path, const LegsConfig& config, const TimeSpan& span)
    : path_(path), config_(config), first_s_(span.start_s - 1.0) {
  Wish wish(path);
  std::vector<double> wishes(momentCount({first_s_, span.end_s + 1.0}, kFacing_hz));
  for (std::size_t i = 0; i < wishes.size(); ++i) {
    wishes[i] = wish.at(first_s_ + static_cast<double>(i) / kFacing_hz);
  }
  facing_rad_ = smoothed(smoothed(wishes));
}

double Body::facingAt(double time_s) const {
  const double x = (time_s - first_s_) * kFacing_hz;
  const auto last = static_cast<double>(facing_rad_.size() - 1);
  const auto i = static_cast<std::size_t>(std::clamp(std::floor(x), 0.0, last - 1.0));
  const double part = std::clamp(x - static_cast<double>(i), 0.0, 1.0);
  return (1.0 - part) * facing_rad_[i] + part * facing_rad_[i + 1];
}

BodyPose Body::at(double time_s) const {
  const Isometry3d T_world_camera = path_.at(time_s);
  const Matrix3d head = about(-facingAt(time_s), Vector3d::UnitZ()) * T_world_camera.linear() *
                        bodyFromOptical().linear().transpose();
  BodyPose pose;
  pose.neck.yaw_rad = std::clamp(headingOf(head), -kMostYaw_rad, kMostYaw_rad);
  pose.neck.pitch_rad =
      std::clamp(std::asin(std::clamp(-head(2, 0), -1.0, 1.0)), -kMostPitch_rad, kMostPitch_rad);
  pose.T_world_base = T_world_camera * baseFromCamera(config_, pose.neck).inverse();
  return pose;
}

}  // namespace pf::simulator

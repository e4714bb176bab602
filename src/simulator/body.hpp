// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/camera_path.hpp"
#include "simulator/legs_config.hpp"

namespace pf::simulator {

/// The two joints of a neck: yaw to the left, then pitch downwards. Radians.
struct NeckAngles {
  double yaw_rad = 0.0;
  double pitch_rad = 0.0;
};

/// A body and its neck at one moment.
struct BodyPose {
  Eigen::Isometry3d T_world_base = Eigen::Isometry3d::Identity();
  NeckAngles neck;
};

/// Camera coordinates to those of base_link (x ahead, y left, z up) by the joints of the neck.
Eigen::Isometry3d baseFromCamera(const LegsConfig& config, const NeckAngles& neck);

/// As measured by the encoders of the joints.
NeckAngles encoded(const LegsConfig& config, const NeckAngles& neck);

/// The heading of a frame whose x axis is ahead: rad, about z.
double headingOf(const Eigen::Matrix3d& rotation);

/// The body that carries a camera: under it, upright but for what the neck cannot do, and facing
/// where it walks; the neck does the rest. Exact: T_world_base * baseFromCamera() is the camera.
class Body {
 public:
  /// `path` and `config` have to live as long as it.
  Body(const CameraPath& path, const LegsConfig& config, const TimeSpan& span);

  /// At a moment of the span.
  BodyPose at(double time_s) const;

 private:
  double facingAt(double time_s) const;

  const CameraPath& path_;
  const LegsConfig& config_;
  double first_s_;
  std::vector<double> facing_rad_;  // smooth, without jumps from pi to -pi
};

}  // namespace pf::simulator

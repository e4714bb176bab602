// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "posefusion/core/error.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Swings along three axes one after the other, each for two periods, coming and going softly.
Vector3d inTurn(double time_s, double period_s) {
  const double phase = std::fmod(time_s / (2.0 * period_s), 3.0);
  const int axis = std::min(2, static_cast<int>(phase));
  const double within = phase - axis;
  Vector3d v = Vector3d::Zero();
  const double open = std::min(1.0, 2.0 * std::sin(M_PI * within));
  v[axis] = std::sin(2.0 * M_PI * 2.0 * within) * open * (2.0 - open);
  return v;
}

class HandHeldPath : public CameraPath {
 public:
  HandHeldPath(const HandHeld& spec, std::uint32_t seed) : spec_(spec), seed_(seed) {}

  Isometry3d at(double t) const override {
    Isometry3d T = pattern(t);
    const auto noise = [&](std::uint32_t salt) {
      return spec_.shake * tremble(t, 0.25, 6.0, hash(seed_, salt));
    };
    T.translate(Vector3d(0.011 * noise(1U), 0.011 * noise(2U), 0.009 * noise(3U)));
    T.rotate(AngleAxisd(0.016 * noise(4U), Vector3d::UnitX()) *
             AngleAxisd(0.018 * noise(5U), Vector3d::UnitY()) *
             AngleAxisd(0.012 * noise(6U), Vector3d::UnitZ()));
    return T;
  }

 private:
  Isometry3d pattern(double t) const {
    Isometry3d T = lookAt(spec_.eye, spec_.target);
    if (spec_.pattern == "xyz") T.translate(spec_.reach_m * inTurn(t, spec_.period_s));
    if (spec_.pattern == "rpy") {
      const Vector3d a = spec_.swing_rad * inTurn(t, spec_.period_s);
      T.rotate(AngleAxisd(a.z(), Vector3d::UnitZ()) * AngleAxisd(a.y(), Vector3d::UnitY()) *
               AngleAxisd(0.7 * a.x(), Vector3d::UnitX()));
    }
    if (spec_.pattern == "halfsphere") {
      const Vector3d d = spec_.eye - spec_.target;
      const double angle = 0.75 * std::sin(2.0 * M_PI * t / (4.0 * spec_.period_s));
      const double rise = 0.10 - 0.16 * std::cos(2.0 * M_PI * t / (2.6 * spec_.period_s));
      const double radius = std::hypot(d.x(), d.y());
      const double azimuth = std::atan2(d.y(), d.x()) + angle;
      const double elevation = std::atan2(d.z(), radius) + rise;
      const Vector3d out(std::cos(azimuth) * std::cos(elevation),
                         std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
      return lookAt(spec_.target + d.norm() * out, spec_.target);
    }
    return T;
  }

  HandHeld spec_;
  std::uint32_t seed_;
};

}  // namespace

std::size_t momentCount(const TimeSpan& span, double rate_hz) {
  return static_cast<std::size_t>(std::floor((span.end_s - span.start_s) * rate_hz + 1e-6)) + 1;
}

Isometry3d lookAt(const Vector3d& eye, const Vector3d& target) {
  const Vector3d forward = (target - eye).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized();
  Isometry3d T = Isometry3d::Identity();
  T.linear() << right, forward.cross(right), forward;
  T.translation() = eye;
  return T;
}

double tremble(double time_s, double low_hz, double high_hz, std::uint32_t seed) {
  constexpr int kSines = 7;
  double sum = 0.0;
  for (std::uint32_t i = 0; i < kSines; ++i) {
    const double part = (i + 0.8 * uniform(hash(seed, i))) / kSines;
    const double hz = low_hz * std::pow(high_hz / low_hz, part);
    const double height = std::pow(low_hz / hz, 1.05);
    sum += height * std::sin(2.0 * M_PI * (hz * time_s + uniform(hash(seed, i, 9U))));
  }
  return 0.6 * sum;
}

std::unique_ptr<CameraPath> makeHandHeld(const HandHeld& spec, std::uint32_t seed) {
  if ((spec.target - spec.eye).head<2>().norm() < 1e-3) {
    throw InputError("camera: look_at_m is straight above or below at_m, expected another place");
  }
  return std::make_unique<HandHeldPath>(spec, seed);
}

}  // namespace pf::simulator

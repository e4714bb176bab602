// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "simulator/actor.hpp"
#include "simulator/easing.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

constexpr double kDoubleSupport_s = 0.07;

/// Faster walkers take quicker steps.
double swingTime(double speed) { return std::clamp(0.52 - 0.10 * speed, 0.34, 0.5); }

}  // namespace

void Stepper::reset(const Vector2d& at, double yaw, double hip_m) {
  hip_m_ = hip_m;
  swing_ = {};
  for (std::size_t side = 0; side < 2; ++side) {
    feet_[side] = {};
    feet_[side].at = home(side, at, yaw);
    feet_[side].yaw = yaw + (side == 0 ? 0.12 : -0.12);
  }
}

Vector2d Stepper::home(std::size_t side, const Vector2d& at, double yaw) const {
  const double y = side == 0 ? hip_m_ : -hip_m_;
  return at + Vector2d(-std::sin(yaw) * y, std::cos(yaw) * y);
}

void Stepper::swing(std::size_t side, const Vector2d& at, double yaw, const Vector2d& velocity) {
  Swing& s = swing_[side];
  FootState& foot = feet_[side];
  const double speed = velocity.norm();
  const double time = swingTime(speed);
  s.time_s += kActorStep_s;
  const double p = std::min(1.0, s.time_s / time);
  // Lands half a stance ahead of where the body will be by then.
  const double ahead = time * (1.0 - p) + 0.5 * (time + 2.0 * kDoubleSupport_s);
  const Vector2d target = home(side, at, yaw) + ahead * velocity;
  const double yaw_target = yaw + (side == 0 ? 0.10 : -0.10);
  const double e = smooth(p);
  foot.at = s.from.at + e * (target - s.from.at);
  foot.yaw = s.from.yaw + e * std::remainder(yaw_target - s.from.yaw, 2.0 * M_PI);
  foot.lift_m = (0.035 + 0.03 * std::min(speed, 1.5)) * std::sin(M_PI * std::pow(p, 0.8));
  const double strike = -0.28 * std::min(1.0, speed);
  foot.pitch = s.from.pitch * (1.0 - smooth(std::min(1.0, 1.6 * p))) +
               strike * smooth(std::clamp(1.6 * p - 0.6, 0.0, 1.0));
  if (p < 1.0) return;
  s.on = false;
  foot.lift_m = 0.0;
  rest_s_ = 0.0;
  last_ = side;
}

void Stepper::stand(std::size_t side, const Vector2d& at, double yaw) {
  FootState& foot = feet_[side];
  // The heel rises when the foot is left behind.
  const Vector2d lag = at - foot.at;
  const double behind = lag.x() * std::cos(yaw) + lag.y() * std::sin(yaw);
  const double wanted = std::clamp(2.2 * (behind - 0.14), 0.0, 0.75);
  foot.pitch += std::clamp(wanted - foot.pitch, -0.10, 0.10);
}

void Stepper::step(const Vector2d& at, double yaw, const Vector2d& velocity) {
  rest_s_ += kActorStep_s;
  for (std::size_t side = 0; side < 2; ++side) {
    if (swing_[side].on) {
      swing(side, at, yaw, velocity);
    } else {
      stand(side, at, yaw);
    }
  }
  if (swing_[0].on || swing_[1].on || rest_s_ < kDoubleSupport_s) return;
  const bool moving = velocity.norm() > 0.12;
  double worst = 0.0;
  std::size_t side = 1 - last_;
  for (std::size_t i = 0; i < 2; ++i) {
    const double off = (home(i, at, yaw) - feet_[i].at).norm() +
                       0.25 * std::abs(std::remainder(feet_[i].yaw - yaw, 2.0 * M_PI));
    if (off > worst) {
      worst = off;
      if (!moving) side = i;
    }
  }
  if (worst < (moving ? 0.02 : 0.11)) return;
  swing_[side] = {true, 0.0, feet_[side]};
}

}  // namespace pf::simulator

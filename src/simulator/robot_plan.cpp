// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/robot_plan.hpp"

#include <algorithm>
#include <cmath>

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

/// Lays the pieces one after another.
class Planner {
 public:
  Planner(const Robot& spec, double duration_s) : spec_(spec), duration_s_(duration_s) {}

  std::vector<Piece> plan() {
    const Waypoint& first = spec_.waypoints[0];
    place_.at = first.at;
    place_.floor_m = spec_.floor_m;
    const Vector2d ahead = spec_.waypoints[1 % spec_.waypoints.size()].at - place_.at;
    const double yaw = ahead.norm() > 0.0 ? std::atan2(ahead.y(), ahead.x()) : 0.0;
    place_.yaw = first.facing_rad.value_or(yaw);
    std::size_t next = 1;
    add(Piece::Kind::pause, 1.0, place_);
    while (time_s_ < duration_s_) {
      if (next == spec_.waypoints.size()) {
        if (!spec_.repeats || spec_.waypoints.size() < 2) break;
        next = 0;
      }
      if (goTo(spec_.waypoints[next])) ++next;
    }
    add(Piece::Kind::pause, std::max(1.0, duration_s_ - time_s_ + 1.0), place_);
    return pieces_;
  }

 private:
  void add(Piece::Kind kind, double length_s, const Place& to) {
    Piece piece;
    piece.kind = kind;
    piece.start_s = time_s_;
    piece.length_s = length_s;
    piece.from = place_;
    piece.to = to;
    piece.steps_before = steps_;
    if (kind == Piece::Kind::walk || kind == Piece::Kind::turn) {
      // A whole number of steps, so that both feet stand at the end.
      steps_ += std::max(1.0, std::round(length_s / spec_.step_s));
    }
    pieces_.push_back(piece);
    time_s_ += length_s;
    place_ = to;
  }

  void turnTo(double yaw) {
    const double angle = std::remainder(yaw - place_.yaw, 2.0 * M_PI);
    if (std::abs(angle) < 0.02) return;
    const double time = std::max(spec_.step_s, std::abs(angle) / spec_.turn_rad_s);
    add(Piece::Kind::turn, time, {place_.at, place_.yaw + angle, place_.floor_m});
  }

  /// Walks on towards a waypoint; false when a fall came between.
  bool goTo(const Waypoint& waypoint) {
    const Vector2d goal = waypoint.at, d = goal - place_.at;
    if (waypoint.facing_rad) turnTo(*waypoint.facing_rad);
    if (d.norm() < 0.02) return true;
    if (!waypoint.facing_rad) turnTo(std::atan2(d.y(), d.x()));
    const double time = std::max(spec_.step_s, d.norm() / spec_.speed_m_s);
    const bool falls =
        next_fall_ < spec_.falls.size() && spec_.falls[next_fall_].at_s < time_s_ + time;
    if (!falls) {
      add(Piece::Kind::walk, time, {goal, place_.yaw, place_.floor_m});
      if (spec_.pause_s > 0.0) add(Piece::Kind::pause, spec_.pause_s, place_);
      return true;
    }
    const Fall& fall = spec_.falls[next_fall_++];
    const double until = std::max(spec_.step_s, fall.at_s - time_s_);
    const double part = std::min(1.0, until / time);
    add(Piece::Kind::walk, until, {place_.at + part * d, place_.yaw, place_.floor_m});
    const double skip = std::min(fall.skip_m, (1.0 - part) * d.norm());
    const Place up{place_.at + skip * d.normalized(), place_.yaw + fall.turn_rad,
                   place_.floor_m - fall.down_m};
    add(Piece::Kind::fall, kStagger_s + fall.drop_s + fall.lie_s + kGetUp_s, up);
    pieces_.back().fall = fall;
    add(Piece::Kind::pause, 1.0, place_);
    return (goal - place_.at).norm() < 0.02;
  }

  const Robot& spec_;
  double duration_s_;
  std::vector<Piece> pieces_;
  Place place_;
  double time_s_ = 0.0;
  double steps_ = 0.0;
  std::size_t next_fall_ = 0;
};

}  // namespace

std::vector<Piece> planRobot(const Robot& spec, double duration_s) {
  return Planner(spec, duration_s).plan();
}

}  // namespace pf::simulator

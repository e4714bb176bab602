// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "posefusion/core/error.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/easing.hpp"
#include "simulator/random.hpp"
#include "simulator/robot_plan.hpp"

namespace pf::simulator {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFloorHeight_m = 0.24;
/// Body and floor give way: the last part of a drop.
constexpr double kCrush = 0.107;
constexpr double kOnset_s = 0.02;  // of what rings through the body

/// How quickly a drop is stopped, so that there is no jump of the speed.
double stopOf(const Fall& fall) { return 0.5 * kCrush / (1.0 - kCrush) * fall.drop_s; }

/// A damped swing that begins softly.
double ringing(double since_s, double decay_s, double rad_s) {
  return (1.0 - std::exp(-since_s / kOnset_s)) * std::exp(-since_s / decay_s) *
         std::sin(rad_s * since_s);
}

class RobotPath : public CameraPath {
 public:
  RobotPath(const Robot& spec, double duration_s, std::uint32_t seed)
      : spec_(spec), seed_(seed), pieces_(planRobot(spec_, duration_s)) {}

  Isometry3d at(double t) const override {
    const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), t,
                                        [](double x, const Piece& p) { return x < p.start_s; });
    const Piece& piece = after == pieces_.begin() ? *after : *(after - 1);
    const double since = std::clamp(t - piece.start_s, 0.0, piece.length_s);
    if (piece.kind == Piece::Kind::fall) {
      const double still = std::min(since / kStagger_s, (piece.length_s - since) / kGetUp_s);
      return fallen(piece, since) * balance(t, 1.0 - smooth(std::clamp(still, 0.0, 1.0)));
    }
    double part = since / piece.length_s;
    // Walking starts and ends softly, over one step.
    const double ramp = std::min(0.4, spec_.step_s / piece.length_s);
    part = soften(part, ramp);
    const Vector2d place = piece.from.at + part * (piece.to.at - piece.from.at);
    const double yaw = piece.from.yaw + part * (piece.to.yaw - piece.from.yaw);
    const bool moving = piece.kind != Piece::Kind::pause;
    const Isometry3d T = standing({place, yaw, piece.to.floor_m}) * balance(t, 1.0);
    return moving ? T * gait(piece, since) : T;
  }

  std::vector<Event> events() const override {
    std::vector<Event> events;
    for (const Piece& p : pieces_) {
      if (p.kind == Piece::Kind::fall) {
        events.push_back({"fall", p.start_s, p.start_s + p.length_s});
      }
    }
    return events;
  }

  bool walks() const override { return true; }

 private:
  /// The part of a way after the part `x` of its time, with speed rising and falling over `ramp`.
  static double soften(double x, double ramp) {
    const double area = 1.0 - ramp;
    if (x < ramp) return 0.5 * x * x / ramp / area;
    if (x > 1.0 - ramp) return 1.0 - 0.5 * (1.0 - x) * (1.0 - x) / ramp / area;
    return (x - 0.5 * ramp) / area;
  }

  Isometry3d standing(const Place& place) const {
    const Vector3d eye(place.at.x(), place.at.y(), place.floor_m + spec_.height_m);
    if (!spec_.turns_body) return lookAt(eye, spec_.target);
    return lookAt(
        eye, eye + Vector3d(std::cos(place.yaw), std::sin(place.yaw), -std::tan(spec_.pitch_rad)));
  }

  static Isometry3d moved(const Vector3d& by, const Vector3d& turn) {
    Isometry3d T = Isometry3d::Identity();
    T.translate(by);
    T.rotate(AngleAxisd(turn.z(), Vector3d::UnitZ()) * AngleAxisd(turn.y(), Vector3d::UnitY()) *
             AngleAxisd(turn.x(), Vector3d::UnitX()));
    return T;
  }

  /// Small slow movements of a body that keeps its balance, in the camera frame.
  Isometry3d balance(double t, double strength) const {
    const auto slow = [&](std::uint32_t salt) { return tremble(t, 0.2, 2.0, hash(seed_, salt)); };
    return moved(strength * Vector3d(0.002 * slow(1U), 0.001 * slow(2U), 0.002 * slow(3U)),
                 strength * Vector3d(0.006 * slow(4U), 0.008 * slow(5U), 0.003 * slow(6U)));
  }

  /// Movement of the head by walking, in the camera frame.
  Isometry3d gait(const Piece& piece, double since) const {
    const double count = std::max(1.0, std::round(piece.length_s / spec_.step_s));
    const double phase = since / piece.length_s * count;
    const double step = std::floor(phase), within = phase - step;
    const double strength = std::min({1.0, phase + 0.3, count - phase + 0.3});
    const double side = std::fmod(piece.steps_before + step, 2.0) < 0.5 ? 1.0 : -1.0;
    // Standing still at both ends of the way, with the weight on one foot in between.
    const double ends = smooth(std::clamp(std::min(phase, count - phase) / 0.5, 0.0, 1.0));
    const double arc = std::sin(M_PI * within);
    Vector3d move =
        strength * Vector3d(side * spec_.sway_m * arc, -spec_.bounce_m * arc * arc, 0.0);
    Vector3d turn = strength * Vector3d(0.012 * std::sin(2.0 * M_PI * within), 0.010 * side * arc,
                                        -0.020 * side * arc);
    addStrike(within * piece.length_s / count,
              static_cast<std::uint32_t>(piece.steps_before + step), strength, move, turn);
    return moved(ends * move, ends * turn);
  }

  /// The heel strike rings through the body: damped, about 10 Hz, never twice the same.
  void addStrike(double since_s, std::uint32_t step, double strength, Vector3d& move,
                 Vector3d& turn) const {
    const double height = spec_.jerk * strength * between(hash(seed_, 21U, step), 0.4, 1.6);
    const double ring = height * ringing(since_s, 0.09, 2.0 * M_PI * 9.5);
    move.y() += 0.0045 * ring;
    turn.x() += 0.016 * ring;
    turn.z() += 0.008 * ring * (uniform(hash(seed_, 22U, step)) - 0.5);
    turn.y() += 0.008 * ring * (uniform(hash(seed_, 23U, step)) - 0.5);
  }

  Isometry3d lying(const Piece& piece) const {
    const Vector2d ahead(std::cos(piece.from.yaw), std::sin(piece.from.yaw));
    const double sign = piece.fall.direction == "backward" ? -1.0 : 1.0;
    Isometry3d T = standing({piece.from.at + sign * piece.fall.ahead_m * ahead, piece.from.yaw});
    T.translation().z() = piece.to.floor_m + kFloorHeight_m;
    if (piece.fall.direction == "forward") T.rotate(AngleAxisd(-1.15, Vector3d::UnitX()));
    if (piece.fall.direction == "backward") T.rotate(AngleAxisd(1.25, Vector3d::UnitX()));
    if (piece.fall.direction == "sideways") T.rotate(AngleAxisd(1.35, Vector3d::UnitZ()));
    return T;
  }

  static Isometry3d mix(const Isometry3d& a, const Isometry3d& b, double t) {
    Isometry3d T = Isometry3d::Identity();
    T.linear() =
        Eigen::Quaterniond(a.linear()).slerp(t, Eigen::Quaterniond(b.linear())).toRotationMatrix();
    T.translation() = a.translation() + t * (b.translation() - a.translation());
    return T;
  }

  /// Each edge of the stairs gives the body a knock, to one side and the other.
  static void addBumps(const Fall& fall, double since_s, Isometry3d& T) {
    for (int i = 0; i < fall.bumps; ++i) {
      const double after_s = since_s - fall.drop_s * (i + 1.0) / (fall.bumps + 1.0);
      if (after_s <= 0.0) continue;
      const double knock = ringing(after_s, 0.10, 42.0), side = i % 2 == 0 ? 1.0 : -1.0;
      T.translate(Vector3d(0.010 * side * knock, -0.020 * knock, 0.0));
      T.rotate(AngleAxisd(0.10 * knock, Vector3d::UnitX()) *
               AngleAxisd(0.12 * side * knock, Vector3d::UnitZ()));
    }
  }

  Isometry3d fallen(const Piece& piece, double since) const {
    const Isometry3d up = standing(piece.from), down = lying(piece);
    const Isometry3d again = standing(piece.to);
    const double impact = since - kStagger_s - piece.fall.drop_s;
    if (impact < 0.0) {
      // It tips slowly, then gravity takes over.
      const double tip = 0.10 * std::pow(std::min(1.0, since / kStagger_s), 2.0);
      const double drop = std::max(0.0, (since - kStagger_s) / piece.fall.drop_s);
      Isometry3d T = mix(up, down, tip + (1.0 - tip) * (1.0 - kCrush) * drop * drop);
      T.rotate(AngleAxisd(0.05 * std::sin(18.0 * since) * since * (1.0 - drop), Vector3d::UnitZ()));
      addBumps(piece.fall, since - kStagger_s, T);
      return T;
    }
    const double rise = smooth(std::clamp((impact - piece.fall.lie_s) / kGetUp_s, 0.0, 1.0));
    const double crushed = 1.0 - 0.9 * kCrush * std::exp(-impact / stopOf(piece.fall));
    Isometry3d T = mix(mix(up, down, crushed), again, rise);
    const double hop = std::sin(14.0 * impact);
    T.translate(Vector3d(0.0, -0.05 * std::exp(-impact / 0.16) * hop * hop, 0.0));
    addBumps(piece.fall, since - kStagger_s, T);
    const double effort = 4.0 * rise * (1.0 - rise);
    T.rotate(AngleAxisd(0.16 * ringing(impact, 0.16, 40.0) +
                            0.10 * effort * tremble(since, 0.5, 5.0, seed_ + 31U),
                        Vector3d::UnitX()) *
             AngleAxisd(0.12 * ringing(impact, 0.16, 31.0) +
                            0.10 * effort * tremble(since, 0.5, 5.0, seed_ + 32U),
                        Vector3d::UnitZ()));
    return T;
  }

  Robot spec_;
  std::uint32_t seed_;
  std::vector<Piece> pieces_;
};

}  // namespace

std::unique_ptr<CameraPath> makeRobot(const Robot& spec, double duration_s, std::uint32_t seed) {
  if (spec.waypoints.empty())
    throw InputError("camera: waypoints is empty, expected [[x, y], ...]");
  return std::make_unique<RobotPath>(spec, duration_s, seed);
}

}  // namespace pf::simulator

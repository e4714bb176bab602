// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pf::simulator {

/// Something of note that happened to the camera.
struct Event {
  std::string kind;  ///< "fall"
  double start_s = 0.0;
  double end_s = 0.0;
};

/// Where the camera is at any time. Thread safe.
class CameraPath {
 public:
  virtual ~CameraPath() = default;
  virtual Eigen::Isometry3d at(double time_s) const = 0;
  virtual std::vector<Event> events() const { return {}; }
  virtual bool walks() const { return false; }  ///< on legs of its own
};

/// Seconds of a scenario.
struct TimeSpan {
  double start_s = 0.0;
  double end_s = 0.0;
};

/// How many moments of this rate are in a span, both ends included.
std::size_t momentCount(const TimeSpan& span, double rate_hz);

/// Camera at `eye` that looks at `target`, upright (optical frame: z forward, y down).
Eigen::Isometry3d lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

/// Hand-held patterns of the TUM benchmark about a first view.
struct HandHeld {
  std::string pattern = "static";  ///< static, xyz, rpy, halfsphere
  Eigen::Vector3d eye{0.0, 0.0, 1.3};
  Eigen::Vector3d target{2.0, 0.0, 1.1};
  double reach_m = 0.25;    ///< xyz: to either side
  double swing_rad = 0.30;  ///< rpy
  double period_s = 4.0;    ///< of one swing
  double shake = 1.0;       ///< tremble of the hand, 1 = usual, 0 = a tripod
};

/// A fall: when, and how: "forward" face down, "backward" to the ceiling, "sideways".
struct Fall {
  double at_s = 0.0;
  std::string direction = "forward";
  double lie_s = 3.0;
  double skip_m = 1.0;    ///< it gets up so far along its way
  double turn_rad = 0.8;  ///< and looks elsewhere by so much
  double down_m = 0.0;    ///< down stairs: onto a floor so much lower
  double ahead_m = 0.35;  ///< the head comes to lie so far before where it stood
  double drop_s = 0.5;    ///< from losing its balance to the impact
  int bumps = 0;          ///< on stairs, on the way down
};

/// Where a robot walks to, and where it faces on the way: there, unless it is said.
struct Waypoint {
  Waypoint(double x, double y) : at(x, y) {}
  Waypoint(const Eigen::Vector2d& place, std::optional<double> facing)
      : at(place), facing_rad(facing) {}

  Eigen::Vector2d at;
  std::optional<double> facing_rad;
};

/// A biped that walks along waypoints, with its falls.
struct Robot {
  std::vector<Waypoint> waypoints;
  bool finds_way = false;  ///< round furniture and through doorways; otherwise it walks straight
  double stray_m = 0.0;    ///< by the seed, from waypoints without a facing; see settled()
  bool repeats = true;     ///< starts again at the first waypoint
  bool turns_body = true;  ///< faces where it goes; otherwise looks at `target`
  Eigen::Vector3d target = Eigen::Vector3d::Zero();
  double height_m = 1.40;
  double floor_m = 0.0;     ///< the floor that it begins on
  double pitch_rad = 0.12;  ///< downwards
  double speed_m_s = 0.28;
  double turn_rad_s = 0.5;
  double step_s = 0.75;
  double sway_m = 0.022;
  double bounce_m = 0.008;
  double jerk = 1.0;     ///< of the heel strike, 1 = usual
  double pause_s = 0.6;  ///< at every waypoint
  std::vector<Fall> falls;
};

std::unique_ptr<CameraPath> makeHandHeld(const HandHeld& spec, std::uint32_t seed);
std::unique_ptr<CameraPath> makeRobot(const Robot& spec, double duration_s, std::uint32_t seed);

/// Irregular movement in about [-1, 1]: sines from `low_hz` to `high_hz`, slower ones larger.
double tremble(double time_s, double low_hz, double high_hz, std::uint32_t seed);

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/crowd.hpp"

namespace pf::simulator {

constexpr double kActorStep_s = 1.0 / 60.0;

/// Puts the feet: one swings while the other stands, towards where the body will be.
class Stepper {
 public:
  void reset(const Eigen::Vector2d& at, double yaw, double hip_m);
  /// Moves the feet one step of time for a body at `at` that moves with `velocity`.
  void step(const Eigen::Vector2d& at, double yaw, const Eigen::Vector2d& velocity);
  const std::array<FootState, 2>& feet() const { return feet_; }

 private:
  struct Swing {
    bool on = false;
    double time_s = 0.0;
    FootState from;
  };
  void swing(std::size_t side, const Eigen::Vector2d& at, double yaw,
             const Eigen::Vector2d& velocity);
  void stand(std::size_t side, const Eigen::Vector2d& at, double yaw);
  Eigen::Vector2d home(std::size_t side, const Eigen::Vector2d& at, double yaw) const;

  std::array<FootState, 2> feet_;
  std::array<Swing, 2> swing_;
  double hip_m_ = 0.1;
  double rest_s_ = 0.0;  ///< since the last swing ended
  std::size_t last_ = 0;
};

/// One person playing a script.
class Actor {
 public:
  Actor(const PersonSpec& spec, const Walkway& walkway);
  const ActorState& state() const { return state_; }

  /// Where the body is over the floor: behind the feet while sitting.
  Eigen::Vector2d bodyPlace() const;

  /// One step of time; `others` are places to keep clear of.
  void step(const std::vector<Eigen::Vector2d>& others);

  /// Moves a walking or standing body aside (not a seated one).
  void push(const Eigen::Vector2d& by);

 private:
  const Action& action() const;
  void begin();
  void planWay();
  bool play(const std::vector<Eigen::Vector2d>& others);  ///< true when the action is over
  bool walk(const Eigen::Vector2d& goal, double speed, const std::vector<Eigen::Vector2d>& others);
  bool turnTo(double yaw);
  void keepOffWalls(const Eigen::Vector2d& before);
  bool playSit(const std::vector<Eigen::Vector2d>& others);
  void settleHeight();

  PersonSpec spec_;
  const Walkway* walkway_;
  Rig rig_;
  ActorState state_;
  Stepper stepper_;
  std::size_t current_ = 0;
  double action_s_ = 0.0;
  double keeps_right_s_ = 0.0;
  bool over_ = false;
  std::vector<Eigen::Vector2d> way_;
  std::size_t leg_ = 0;
  double sit_wanted_ = 0, crouch_wanted_ = 0, talk_wanted_ = 0, reach_wanted_ = 0,
         carry_wanted_ = 0;
};

/// How far the hips are behind the feet when seated, metres for a height of 1.75 m.
constexpr double kSeatBehind_m = 0.40;

}  // namespace pf::simulator

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

/// From the floor or a table into the arms, and back.
constexpr double kLift_s = 1.3;

/// One person playing a script.
class Actor {
 public:
  /// `things` that the script moves, if any; `number` of the person.
  Actor(const PersonSpec& spec, const Walkway& walkway, ThingStage* things = nullptr,
        std::size_t number = 0);
  const ActorState& state() const { return state_; }

  /// Where the body is over the floor: behind the feet while sitting.
  Eigen::Vector2d bodyPlace() const;

  /// Whether it is about to do something with a thing.
  bool handlesThing() const { return action().kind >= Action::Kind::take; }

  /// One step of time; `others` are places to keep clear of.
  void step(const std::vector<Eigen::Vector2d>& others);

  /// Moves a walking or standing body aside (not a seated one).
  void push(const Eigen::Vector2d& by);

  /// What is held follows the body, and the hands what is held: to be called when the body is where
  /// it will be in this step.
  void carry();

 private:
  const Action& action() const;
  void begin();
  void planWay();
  bool play(const std::vector<Eigen::Vector2d>& others);  ///< true when the action is over
  bool walk(const Eigen::Vector2d& goal, double speed, const std::vector<Eigen::Vector2d>& others);
  /// Those, and the things that stand on the way there.
  std::vector<Eigen::Vector2d> inTheWay(std::vector<Eigen::Vector2d> others,
                                        const Eigen::Vector2d& way) const;
  bool turnTo(double yaw);
  void keepOffWalls(const Eigen::Vector2d& before);
  bool playSit(const std::vector<Eigen::Vector2d>& others);
  bool playThing(const std::vector<Eigen::Vector2d>& others);
  bool playTake(const std::vector<Eigen::Vector2d>& others);
  bool playPut(const std::vector<Eigen::Vector2d>& others);
  bool playPush(const std::vector<Eigen::Vector2d>& others);
  bool playSwing();
  void planThing();
  bool goTo(const Eigen::Vector2d& spot, double yaw, double speed,
            const std::vector<Eigen::Vector2d>& others);
  Eigen::Vector2d spotAt(const Eigen::Vector2d& place, double reach_m) const;
  ThingPose carriedPose() const;
  ThingPose pushedPose() const;
  ThingPose swungPose(double t) const;
  Eigen::Vector3d handleOf(const ThingPose& pose) const;
  void graspSides(const ThingPose& pose);
  void graspBack(const ThingPose& pose);
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
         carry_wanted_ = 0, grasp_wanted_ = 0;

  /// What a person has to do with a thing.
  enum class Grip { none, follows, lifts, lowers, pushes, swings };
  ThingStage* things_;
  std::size_t number_;
  Grip grip_ = Grip::none;
  std::size_t thing_ = 0;  ///< that is held
  int phase_ = 0;          ///< of an action with a thing
  double grip_s_ = 0.0;    ///< since it was lifted, lowered, swung
  Eigen::Vector2d spot_;   ///< to stand at for it
  double spot_yaw_ = 0.0;
  ThingPose rest_;     ///< where it stood or will stand
  ThingPose in_body_;  ///< the thing in the frame of the feet
};

/// How far the hips are behind the feet when seated, metres for a height of 1.75 m.
constexpr double kSeatBehind_m = 0.40;

}  // namespace pf::simulator

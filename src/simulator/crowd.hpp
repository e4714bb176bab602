// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "simulator/script.hpp"
#include "simulator/thing_stage.hpp"
#include "simulator/walkway.hpp"

namespace pf::simulator {

/// A foot: the place of its ankle over the floor, height of the sole, direction and pitch.
struct FootState {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double lift_m = 0.0;
  double yaw = 0.0;
  double pitch = 0.0;  ///< positive: heel up
};

/// What the body does at one moment; amounts from 0 to 1.
struct ActorState {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double yaw = 0.0;
  double speed_m_s = 0.0;
  double pelvis_m = 0.9;          ///< height of the hips
  std::array<FootState, 2> feet;  ///< left, right
  double sit = 0.0, crouch = 0.0, talk = 0.0, reach = 0.0, carry = 0.0;
  Eigen::Vector3d reach_at = Eigen::Vector3d::Zero();
  double grasp = 0.0;  ///< both hands at a thing
  std::array<Eigen::Vector3d, 2> grasp_at{Eigen::Vector3d::Zero(),
                                          Eigen::Vector3d::Zero()};  ///< left, right
  double seat_m = 0.45;
  double time_s = 0.0;
};

/// State between two moments, `t` in [0, 1].
ActorState interpolate(const ActorState& a, const ActorState& b, double t);

/// All people over time: their scripts played in steps of 1/60 s, before anything is drawn, so that
/// any frame can be asked for. They keep clear of each other, of furniture and of the camera, and
/// walk round things that stand.
class Crowd {
 public:
  /// `camera` gives the camera's place over the floor by time. `things` play along, if given.
  Crowd(const std::vector<PersonSpec>& people, const Walkway& walkway,
        const std::function<Eigen::Vector2d(double)>& camera, double duration_s,
        ThingStage* things = nullptr);

  ActorState at(std::size_t person, double time_s) const;
  std::size_t size() const { return tracks_.size(); }

 private:
  std::vector<std::vector<ActorState>> tracks_;
};

}  // namespace pf::simulator

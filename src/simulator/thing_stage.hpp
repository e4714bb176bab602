// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "simulator/thing_track.hpp"

namespace pf::simulator {

/// What the camera has of a ball (centre, radius, m) at a time (s).
struct ThingWatch {
  using Answer = std::function<bool(const Eigen::Vector3d&, double, double)>;
  Answer may_see;  ///< a part of it may be in the picture
  Answer sees;     ///< its centre is in the picture, near enough, nothing before it
};

/// The things of a scenario while its people play, step by step: they move by themselves, or with
/// the people that hold them. Not thread safe.
class ThingStage {
 public:
  ThingStage(const std::vector<ThingSpec>& specs, const std::vector<ThingShape>& shapes,
             ThingWatch watch);

  std::size_t size() const { return specs_.size(); }
  const ThingSpec& spec(std::size_t thing) const { return specs_[thing]; }
  const ThingPose& pose(std::size_t thing) const { return now_[thing].pose; }
  const Eigen::AlignedBox3d& box(std::size_t thing) const { return boxes_[thing]; }
  /// Half of its extent (m) in a direction of the world's floor.
  double halfExtent(std::size_t thing, double yaw_rad) const;

  /// A person moves it, or it moves itself.
  bool isBusy(std::size_t thing) const;
  void take(std::size_t thing, std::size_t person);
  void put(std::size_t thing, const ThingPose& pose) { now_[thing].pose = pose; }
  void leave(std::size_t thing);

  /// The middles of those that stand on the floor within `reach_m` of a place.
  std::vector<Eigen::Vector2d> standingNear(const Eigen::Vector2d& place, double reach_m) const;

  /// Begins the step at this time: things move by themselves.
  void advance(double time_s);
  /// Ends it: poses are kept.
  void record();

  const std::vector<ThingTrack>& tracks() const { return tracks_; }

 private:
  /// A thing at work on one of its moves.
  struct Now {
    ThingPose pose;
    int mover = ThingTrack::kAtRest;
    std::size_t next = 0;   ///< move
    double begun_s = -1.0;  ///< the move under way; negative: none
    ThingPose from;
    std::vector<Eigen::Vector3d> way;  ///< of the move under way
  };
  ThingPose poseOn(const Now& now, const ThingMove& move, std::size_t thing, double t) const;
  void prepare(const ThingMove& move, Now& now) const;
  bool mayBegin(const ThingMove& move, std::size_t thing, double time_s) const;

  std::vector<ThingSpec> specs_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  ThingWatch watch_;
  std::vector<Now> now_;
  std::vector<ThingTrack> tracks_;
};

/// A bent way of straight legs with its corners cut twice, ends kept (Chaikin 1974).
std::vector<Eigen::Vector3d> rounded(std::vector<Eigen::Vector3d> way);

}  // namespace pf::simulator

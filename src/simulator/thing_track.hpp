// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulator/thing.hpp"

namespace pf::simulator {

/// A thing leaves a place and takes another one.
struct ThingChange {
  double begin_s = 0.0, end_s = 0.0;
  ThingPose from, to;
  int mover = 0;        ///< as of ThingTrack
  bool is_over = true;  ///< false: the recording ends before
};

/// A thing over the whole time, in steps of kActorStep_s. Thread safe once it is made.
class ThingTrack {
 public:
  static constexpr int kAtRest = -2, kItself = -1;  ///< else the number of the person that moves it

  void add(const ThingPose& pose, int mover) { steps_.push_back({pose, mover}); }
  /// It stays at its first place, and no person touches it.
  void freeze();

  ThingPose at(double time_s) const;
  /// Whether it is held or its pose changes within 0.1 s.
  bool isMoving(double time_s) const;
  /// m/s, of its origin.
  double speed(double time_s) const;
  /// What of it happens between two times; a change under way at the end of it ends there.
  std::vector<ThingChange> changes(double from_s, double to_s) const;
  /// The times (s) in the span between which its pose is interpolated, both ends included.
  std::vector<double> knots(double from_s, double to_s) const;

 private:
  struct Step {
    ThingPose pose;
    int mover;
  };
  bool changesAfter(std::size_t step) const;

  std::vector<Step> steps_;
};

}  // namespace pf::simulator

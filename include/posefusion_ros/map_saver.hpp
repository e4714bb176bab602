// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace posefusion_ros {

/// Writes map.ply and trajectory.txt into a folder, in the core's map frame (the first camera
/// pose), as the offline runner does. Until then trajectory.partial.txt grows there pose by pose.
class MapSaver {
 public:
  /// An empty `folder`: save() writes to "posefusion_output" in the working folder when it is
  /// called, and isOn() is false.
  explicit MapSaver(const std::string& folder);

  /// The user named a folder: save at the end too.
  bool isOn() const { return is_on_; }

  /// Returns a sentence that tells where everything is. Throws InputError naming what cannot be
  /// written.
  std::string save(const pf::SurfelMap& map, const pf::Trajectory& trajectory);

  /// At the end: as save(), but an error is the sentence that is returned. The partial trajectory
  /// goes when the whole one is there.
  std::string finish(const pf::SurfelMap& map, const pf::Trajectory& trajectory);

  /// As save(), into a numbered folder below, so that a later save does not write over it. The
  /// partial trajectory goes, or stays as trajectory.partial.txt.old where this throws.
  std::string saveBeforeReset(const pf::SurfelMap& map, const pf::Trajectory& trajectory);

  /// A pose of the trajectory, for the partial file, where a folder was named. Returns what went
  /// wrong (disk full), empty when all is well.
  std::string note(const pf::StampedPose& pose);

  /// The trajectory begins anew; nobody wants the partial file.
  void discard();

 private:
  std::string folder_;
  bool is_on_;
  int resets_ = 0;
  std::unique_ptr<pf::TrajectoryJournal> journal_;  // from the first pose on
};

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace posefusion_ros {

/// Writes map.ply and trajectory.txt into a folder, in the core's map frame (the first camera
/// pose), as the offline runner does.
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

  /// The same, but an error is the sentence that is returned.
  std::string tryToSave(const pf::SurfelMap& map, const pf::Trajectory& trajectory);

  /// As save(), into a numbered folder below, so that a later save does not write over it.
  std::string saveBeforeReset(const pf::SurfelMap& map, const pf::Trajectory& trajectory);

 private:
  std::string folder_;
  bool is_on_;
  int resets_ = 0;
};

}  // namespace posefusion_ros

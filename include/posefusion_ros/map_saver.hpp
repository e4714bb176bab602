// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/run_folder.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

struct MapSaverSettings {
  std::string output;    ///< folder of the folders; empty: "posefusion_output", on request only
  double period_s = 60;  ///< how often the map is saved on the way (wall); 0: never
  int maps_kept = 5;     ///< of the maps that beginAnew() saved; 0: all
};

/// Reads `output`, `save_period_s` and `maps_kept`.
MapSaverSettings readMapSaver(Parameters& parameters);

/// Writes map.ply and trajectory.txt in the map frame of TF; where no robot says otherwise that is
/// the frame in which the offline runner writes them. Each map gets a pf::RunFolder of its own, so
/// that none is written over by another. Until it is saved, trajectory.partial.txt grows there pose
/// by pose.
class MapSaver {
 public:
  /// Where an output was named, throws InputError when nothing can be written there.
  explicit MapSaver(const MapSaverSettings& settings);
  ~MapSaver();

  /// The user named a folder: save at the end too.
  bool isOn() const { return !settings_.output.empty(); }

  /// The core's map in the map frame, once it is known; until then the first camera is level.
  void setFrame(const Eigen::Isometry3d& T_map_start) { T_map_start_ = T_map_start; }

  /// Returns a sentence that tells what was written where. Throws InputError when there is nothing
  /// to save, or naming what cannot be written.
  std::string save(const pf::SurfelMap& map, const pf::Trajectory& trajectory);

  /// At the end: as save(), but an error is the sentence that is returned. The partial trajectory
  /// goes when the whole one is there.
  std::string finish(const pf::SurfelMap& map, const pf::Trajectory& trajectory);

  /// Before a map is emptied: save() where a folder was named and there is something, and the next
  /// map gets a folder of its own. Of the maps saved so, all but the newest are removed. Returns
  /// what was written where, empty for nothing. Where this throws, nothing has changed.
  std::string beginAnew(const pf::SurfelMap& map, const pf::Trajectory& trajectory);

  /// As beginAnew(), where that has failed: the partial trajectory is what stays of the old map.
  void abandon();

  /// A pose of the trajectory, for the partial file, where a folder was named; saves the map now
  /// and then. Returns what went wrong or will (disk full), empty when all is well.
  std::string note(const pf::StampedPose& pose, const pf::SurfelMap& map);

 private:
  using Clock = std::chrono::steady_clock;

  const pf::RunFolder& folder();
  void saveOnTheWay(const pf::SurfelMap& map);
  /// Waits for it; returns what went wrong.
  std::string endSaveOnTheWay();

  MapSaverSettings settings_;
  Eigen::Isometry3d T_map_start_ = pf::bodyFromOptical();
  std::optional<pf::RunFolder> folder_;             // of the map that grows now
  std::deque<pf::RunFolder> ended_;                 // of the maps before it, oldest first
  std::unique_ptr<pf::TrajectoryJournal> journal_;  // from the first pose on
  Clock::time_point saved_ = Clock::now();
  std::future<std::string> saving_;
};

}  // namespace posefusion_ros

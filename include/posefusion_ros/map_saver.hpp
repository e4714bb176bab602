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
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

struct MapSaverSettings {
  std::string output;    ///< folder of the folders; empty: "posefusion_output", on request only
  double period_s = 60;  ///< how often map.ply is saved on the way (wall); 0: never
  int maps_kept = 5;     ///< of the maps that beginAnew() saved; 0: all
  std::string settings;  ///< YAML that goes into map files
};

/// Reads `output`, `save_period_s` and `maps_kept`.
MapSaverSettings readMapSaver(Parameters& parameters);

/// What there is to save.
struct MapToSave {
  const pf::Mapper& mapper;
  pf::PinholeCamera camera;  ///< of the frames
  pf::Trajectory trajectory() const { return mapper.backEnd().trajectory(); }
};

/// Writes map.ply, map.pfdb (where the map has changed) and trajectory.txt. The files but map.pfdb
/// lie in the map frame of TF; where no robot says otherwise that is the frame in which the offline
/// runner writes them. Each map gets a pf::RunFolder of its own, so that none is written over by
/// another. Until it is saved, trajectory.partial.txt and
/// map.partial.pfdb grow there.
class MapSaver {
 public:
  /// Where an output was named, throws InputError when nothing can be written there.
  explicit MapSaver(const MapSaverSettings& settings);
  ~MapSaver();

  /// The user named a folder, or a file to go on in: save at the end too.
  bool savesAtTheEnd() const { return isOn() || !continued_.empty(); }

  /// A path as users give it: one that is not absolute begins in `output`.
  std::string resolve(const std::string& path) const;

  /// A map that has just been loaded from a file is written on in that file. Throws InputError
  /// naming it.
  void continueIn(const std::string& file, const MapToSave& map);

  /// Returns a sentence that tells what was written where. Throws InputError when there is nothing
  /// to save, or naming what cannot be written.
  std::string save(const MapToSave& map);

  /// At the end: as save(), but an error is the sentence that is returned. What was partial goes
  /// when the whole is there.
  std::string finish(const MapToSave& map);

  /// Before a map is emptied: save() where a folder was named and there is something, and the next
  /// map gets a folder of its own. Of the maps saved so, all but the newest are removed. Returns
  /// what was written where, empty for nothing. Where this throws, nothing has changed.
  std::string beginAnew(const MapToSave& map);

  /// As beginAnew(), where that has failed: what is partial is what stays of the old map.
  void abandon();

  /// After each frame, where a folder was named: what is partial grows, the map is saved now and
  /// then. `may_change`: it is no map that is only used. Returns what went wrong or will (disk
  /// full), empty when all is well.
  std::string note(const pf::FrameStatus& status, const MapToSave& map, bool may_change);

 private:
  using Clock = std::chrono::steady_clock;

  bool isOn() const { return !settings_.output.empty(); }

  const pf::RunFolder& folder();
  std::string record(const MapToSave& map, bool changed);
  std::string saveContinued(const MapToSave& map);
  void saveDatabase(const MapToSave& map);
  void endRecording();
  void saveOnTheWay(const pf::Mapper& mapper);
  /// Waits for it; returns what went wrong.
  std::string endSaveOnTheWay();

  MapSaverSettings settings_;
  std::optional<pf::RunFolder> folder_;             // of the map that grows now
  std::deque<pf::RunFolder> ended_;                 // of the maps before it, oldest first
  std::unique_ptr<pf::TrajectoryJournal> journal_;  // from the first pose on
  std::optional<pf::MapRecording> recording_;       // from the first frame that was fused on
  std::string continued_;                           // the file that it goes on in, or empty
  Clock::time_point saved_ = Clock::now();
  std::future<std::string> saving_;
};

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/run_folder.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/mesh/triangle_mesh.hpp"
#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/ended_maps.hpp"
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
/// another; until it is ended, trajectory.partial.txt and map.partial.pfdb grow there. What is
/// asked for gets a folder of its own too, which nothing here touches again.
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

  /// On request: writes the map as it is now into a new folder, `<date>_<time>_saved`, which is
  /// there whole or not at all. Returns a sentence that says what was written where. Throws
  /// InputError when there is nothing to save, or naming what cannot be written.
  std::string save(const MapToSave& map);

  /// On request: writes a mesh into a new folder, `<date>_<time>_mesh`, as save() does. Beside the
  /// others, from any thread.
  std::string saveMesh(const pf::TriangleMesh& mesh) const;

  /// Writes the map as it is now into its folder, or the file that it goes on in, and goes on. Says
  /// what was written where; empty where there is nothing, or no folder was named. Throws
  /// InputError naming what cannot be written.
  std::string saveInBetween(const MapToSave& map);

  /// At the end, where a folder was named, or a file to go on in: writes the map into its folder,
  /// or file. What was partial goes when the whole is there. An error is the sentence that is
  /// returned.
  std::string finish(const MapToSave& map);

  /// Before a map is emptied: saves it as at the end where there is something, and the next map
  /// gets a folder of its own. Of the maps saved so, all but the newest are removed, and but that
  /// with the file `next` (real path) that the next map begins in (empty: none). Returns what was
  /// written where, empty for nothing. Where this throws, nothing has changed.
  std::string beginAnew(const MapToSave& map, const std::string& next);

  /// As beginAnew(), where that has failed: what is partial is what stays of the old map.
  void abandon();

  /// After each frame, where a folder was named: what is partial grows, the map is saved now and
  /// then. `may_change`: it is no map that is only used. Returns what went wrong or will (disk
  /// full), empty when all is well.
  std::string note(const pf::FrameStatus& status, const MapToSave& map, bool may_change);

 private:
  using Clock = std::chrono::steady_clock;

  bool isOn() const { return !settings_.output.empty(); }

  /// Folder of the folders.
  std::string output() const;
  const pf::RunFolder& folder();
  std::string saveHere(const MapToSave& map);
  std::string record(const MapToSave& map, bool changed);
  std::string saveContinued(const MapToSave& map);
  void saveDatabase(const MapToSave& map);
  void writeDatabase(const MapToSave& map, const std::string& file) const;
  void endRecording();
  void saveOnTheWay(const pf::Mapper& mapper);
  /// Waits for it; returns what went wrong.
  std::string endSaveOnTheWay();

  MapSaverSettings settings_;
  std::optional<pf::RunFolder> folder_;             // of the map that grows now
  EndedMaps ended_;                                 // folders of the maps before it
  std::unique_ptr<pf::TrajectoryJournal> journal_;  // from the first pose on
  std::optional<pf::MapRecording> recording_;       // from the first frame that was fused on
  std::string continued_;                           // the file that it goes on in, or empty
  Clock::time_point saved_ = Clock::now();
  std::future<std::string> saving_;
};

}  // namespace posefusion_ros

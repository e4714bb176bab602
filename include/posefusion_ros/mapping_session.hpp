// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "posefusion/slam/loop_exchange.hpp"
#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/map_saver.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

struct MappingSettings {
  pf::Config config;
  bool lossless = false;
  MapSaverSettings saver;
  std::string map_file;          ///< to begin in; empty: none
  std::string calibration_file;  ///< file that depth is corrected by; empty: none
  bool localize_only = false;
  bool continue_map = false;  ///< write that file on
};

/// Reads the groups of settings, `lossless`, those of the saver, `map_file`, `localize_only` and
/// `continue_map`. Throws InputError where they contradict each other.
MappingSettings readMapping(Parameters& parameters);

/// Fusion without its topics: the map that grows now, what the loop closer says to it, and its
/// files; begun anew, loaded, switched between mapping and localisation. Not thread safe.
class MappingSession {
 public:
  /// Throws InputError naming the map file, or the folder that cannot be written.
  MappingSession(const MappingSettings& settings, std::unique_ptr<pf::LoopResponder> closer);

  /// `trouble`: what the loop closer threw or could not be written, and goes on; empty for nothing.
  pf::FrameStatus process(const pf::StaticFrame& input, std::string& trouble);

  const pf::Mapper& mapper() const { return *mapper_; }
  const pf::LoopExchange& loops() const { return loops_; }
  const MapSaver& saver() const { return saver_; }
  /// See Mapper.
  void place(const Eigen::Isometry3d& T_world_map) { mapper_->place(T_world_map); }
  /// From the next frame on, for this map and those after it.
  void set(const pf::TrackingConfig& tracking) {
    config_.tracking = tracking;
    mapper_->set(tracking);
  }
  pf::MapUse use() const { return use_; }
  bool isLoaded() const { return !map_file_.empty(); }  ///< the map began in a file

  /// Each returns a sentence that tells what was done, and throws InputError where it changes
  /// nothing. @{
  std::string save() { return saver_.save(toSave()); }
  std::string reset();  ///< saves, and begins an empty map
  /// Saves, and goes on in a map read from `file`.
  std::string load(const std::string& file, pf::SavedMap map);
  std::string setUse(pf::MapUse use);
  /// @}

  /// A recording begins again: saves, and begins an empty map or, where it must not change, this
  /// one again. `lost`: that the old map is, and why it could not be saved; empty where it was.
  std::string startAnew(std::string& lost);

  /// The clock was put back: saves, and goes on in this map, in which the camera is looked for.
  /// `unsaved`: that it could not be saved, and why; empty where it was. Returns what was written
  /// where, empty for nothing.
  std::string restartClock(std::string& unsaved);

  /// At the end: takes in what the closer still has to say, and saves. Returns what was written
  /// where, or why not.
  std::string finish();

 private:
  MapToSave toSave() const { return {*mapper_, camera_}; }
  std::unique_ptr<pf::Mapper> begunIn(pf::SavedMap map, const std::string& file, pf::MapUse use);
  void clear();

  pf::Config config_;
  bool is_lossless_;
  std::optional<pf::DepthCalibration> calibration_;  // of the camera, where it is known
  MapSaver saver_;
  std::unique_ptr<pf::Mapper> mapper_;
  pf::LoopExchange loops_;
  pf::MapUse use_ = pf::MapUse::extend;
  std::string map_file_;      // that the map was loaded from, or empty
  pf::PinholeCamera camera_;  // of the frames of the map; no size before the first
  pf::PinholeCamera seen_;    // of the last frame, of the map or not
};

}  // namespace posefusion_ros

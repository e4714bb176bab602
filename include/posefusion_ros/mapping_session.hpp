// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/slam/loop_exchange.hpp"
#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/calibration_store.hpp"
#include "posefusion_ros/map_saver.hpp"
#include "posefusion_ros/notice.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

struct MappingSettings {
  pf::Config config;
  bool lossless = false;
  MapSaverSettings saver;
  std::string map_file;          ///< to begin in; empty: none
  std::string calibration_file;  ///< file that depth is corrected by; empty: none
  CalibrationStoreSettings store;
  bool localize_only = false;
  bool continue_map = false;  ///< write that file on
};

/// How far the question for a calibration is.
struct CalibrationProgress {
  std::size_t frames = 0;      ///< that came, since the beginning
  std::size_t unanswered = 0;  ///< questions that the loop closer has given up, as long
  int version = 0;             ///< Mapper::depthVersion()
  std::string said;            ///< Mapper::lastCalibration()
};

/// Reads the groups of settings, `lossless`, those of the saver and of the store of calibrations,
/// `map_file`, `calibration_file`, `localize_only` and `continue_map`. Throws InputError where they
/// contradict each other.
MappingSettings readMapping(Parameters& parameters);

/// Fusion without its topics: the map that grows now, what the loop closer says to it, and its
/// files; begun anew, loaded, switched between mapping and localisation; and what is known of its
/// depth camera. Not thread safe.
class MappingSession {
 public:
  /// Throws InputError naming the map or calibration file, or the folder that cannot be written.
  MappingSession(const MappingSettings& settings, std::unique_ptr<pf::LoopResponder> closer);

  /// `camera_frame`: frame_id of the images. `trouble`: what the loop closer threw or could not be
  /// written, and goes on; empty for nothing.
  pf::FrameStatus process(const pf::StaticFrame& input, const std::string& camera_frame,
                          std::string& trouble);

  const pf::Mapper& mapper() const { return *mapper_; }
  const pf::PinholeCamera& camera() const { return camera_; }  ///< of the frames of the map
  const pf::LoopExchange& loops() const { return loops_; }
  const MapSaver& saver() const { return saver_; }
  /// See Mapper. @{
  void addOdometry(const pf::StampedPose& pose) { mapper_->addOdometry(pose); }
  void addImu(const pf::ImuSample& sample) { mapper_->addImu(sample); }
  /// @}

  /// See Mapper.
  void place(const Eigen::Isometry3d& T_world_map) { mapper_->place(T_world_map); }
  std::string hint(const Eigen::Isometry3d& T_world_camera) {
    return mapper_->hint(T_world_camera);
  }
  /// From the next frame on, for this map and those after it.
  void set(const pf::TrackingConfig& tracking) {
    config_.tracking = tracking;
    mapper_->set(tracking);
  }
  pf::MapUse use() const { return use_; }
  bool isLoaded() const { return !map_file_.empty(); }  ///< the map began in a file

  /// What depth is corrected by: "learned", or the file of the correction; empty: nothing.
  std::string correctedBy() const { return mapper_->calibration() ? corrected_by_ : ""; }

  /// What was found out about the depth camera since the last call.
  std::vector<Notice> takeNotices() { return std::exchange(notices_, {}); }

  /// The next frame makes the loop closer estimate the error of the depth camera. Throws InputError
  /// where that cannot be. @{
  void askForCalibration();
  CalibrationProgress calibrationProgress() const;
  /// @}

  /// Each returns a sentence that says what was done, and throws InputError where it changes
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
  std::unique_ptr<pf::Mapper> begunIn(pf::SavedMap map, const std::string& file, pf::MapUse use,
                                      const std::optional<pf::DepthCalibration>& known) const;
  void clear();
  void recallCamera(const std::string& frame_id);
  void noteCorrection(const std::string& file);
  void keepWhatWasLearned(int version_before);

  pf::Config config_;
  bool is_lossless_;
  CalibrationStore store_;
  bool is_camera_named_ = false;  // the store knows the camera of its calibrations
  bool is_unkept_ = false;        // something was learned that could not be written
  bool is_continued_ = false;     // the map file that was begun in is written on
  std::string corrected_by_;      // see correctedBy()
  std::vector<Notice> notices_;
  std::size_t frames_ = 0;  // that came
  MapSaver saver_;
  std::unique_ptr<pf::Mapper> mapper_;
  pf::LoopExchange loops_;
  pf::MapUse use_ = pf::MapUse::extend;
  std::string map_file_;      // that the map was loaded from, or empty
  pf::PinholeCamera camera_;  // of the frames of the map; no size before the first
  pf::PinholeCamera seen_;    // of the last frame, of the map or not
};

}  // namespace posefusion_ros

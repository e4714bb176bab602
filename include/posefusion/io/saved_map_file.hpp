// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <string>

#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/map_database.hpp"
#include "posefusion/slam/mapper.hpp"

namespace pf {

/// Reads all of a map file that a mapper needs. Throws InputError naming the file and what is wrong
/// with it.
SavedMap readSavedMap(const std::string& path);

/// The pose of a map in the user's frame (Mapper::placed()). Throws InputError where the file's
/// pose is impossible.
std::optional<Eigen::Isometry3d> placeOf(const MapContent& content);

/// That the depth of a map was corrected by. Throws InputError where what the file says cannot be.
std::optional<DepthCalibration> calibrationOf(const MapContent& content);

/// That the map of a file was made with; throws InputError naming it.
Config settingsOf(const MapContent& content, const std::string& file);

/// The rectified camera of the first good frame of a recording, which is read for it.
std::optional<PinholeCamera> firstCamera(FrameSource& frames);

/// Why frames of this (rectified) camera do not fit the map of a file; empty when they do. `whose`:
/// words for where the frames are from.
std::string cameraDefect(const std::string& file, const PinholeCamera& of_map,
                         const PinholeCamera& of_frames, const std::string& whose);

/// The same of the first good frame of a recording.
std::string cameraDefect(const std::string& file, const PinholeCamera& of_map, FrameSource& frames,
                         const std::string& whose);

/// Keeps a map file up to date while a mapper works: about twice a second a copy of what has
/// changed is written in a thread of its own, so that a killed process leaves a whole map. Its
/// owner's thread alone may call it.
class MapRecording {
 public:
  /// `extend`: the mapper has loaded that file. Throws InputError naming the file.
  MapRecording(const std::string& path, MapWriter::Mode mode, std::string settings,
               const Mapper& mapper);

  /// After a frame of the mapper; `camera`: of the frame, rectified. Returns what was wrong with
  /// the last write (empty: nothing), which is tried again with the next.
  std::string update(const PinholeCamera& camera, const Mapper& mapper);

  /// Writes the rest; update() may go on. Returns whether there is a map at all. Throws InputError
  /// naming the file.
  bool finish(const Mapper& mapper);

 private:
  /// How much is in the file.
  struct Written {
    int frame = -1;  ///< blocks changed before it; -1: none
    std::size_t frames = 0;
    int keyframes = 0;
    int depth_version = 0;
  };

  static Written amountOf(const Mapper& mapper);
  MapUpdate changes(const Mapper& mapper) const;
  std::string takeResult();

  MapWriter writer_;
  std::string settings_;
  PinholeCamera camera_;
  Written written_, writing_;
  std::future<void> work_;
  std::chrono::steady_clock::time_point begun_{};
};

}  // namespace pf

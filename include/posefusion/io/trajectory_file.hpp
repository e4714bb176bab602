// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <string>

#include "posefusion/core/trajectory.hpp"

namespace pf {

/// Reads the TUM format: `stamp tx ty tz qx qy qz qw` a line, `#` comments. Throws InputError
/// naming file and line.
Trajectory loadTrajectory(const std::string& path);

/// Writes the TUM format to a temporary name and renames it. Throws InputError naming the file.
void saveTrajectory(const std::string& path, const Trajectory& trajectory,
                    const std::string& comment);

/// A trajectory on the disk while it grows, in the TUM format: a process that is killed loses no
/// pose, a power cut about the last second. Poses are those known when the frame was seen. Not
/// thread safe.
class TrajectoryJournal {
 public:
  /// What a killed process left under this name is kept as `<path>.old`. Throws InputError naming
  /// the file.
  TrajectoryJournal(const std::string& path, const std::string& comment);
  /// The file stays.
  ~TrajectoryJournal();
  TrajectoryJournal(const TrajectoryJournal&) = delete;
  TrajectoryJournal& operator=(const TrajectoryJournal&) = delete;

  /// False when the pose could not be written (disk full); the file keeps whole lines, and a later
  /// pose may succeed.
  bool add(const StampedPose& pose);

  /// The trajectory has been saved elsewhere: the file goes.
  void remove();

 private:
  bool append(const std::string& text);
  void syncNowAndThen();

  std::string path_;
  int fd_ = -1;
  std::int64_t size_ = 0;  // of the whole lines, bytes
  std::chrono::steady_clock::time_point synced_;
  std::future<void> syncing_;  // the disk is not waited for
};

}  // namespace pf

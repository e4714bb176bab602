// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "posefusion/calibration/depth_calibration.hpp"
#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

/// Where the calibrations of cameras are kept.
struct CalibrationStoreSettings {
  std::string folder;  ///< empty: none is kept
  std::string serial;  ///< of the camera; empty: the frame of its images names it
};

/// Reads `calibration_folder` (default: defaultCalibrationFolder() where `is_on`) and
/// `camera_serial`.
CalibrationStoreSettings readCalibrationStore(Parameters& parameters, bool is_on);

/// `posefusion/cameras` below `$ROS_HOME` or, where that is not set, `$HOME/.ros`; empty where
/// neither is.
std::string defaultCalibrationFolder();

/// How far off depth is at 2 m by a calibration, RMS over the image (mm).
double errorAt2mMm(const pf::DepthCalibration& calibration);

/// Keeps what is known of each depth camera from session to session, a file for each:
/// `<folder>/<camera>.yaml`.
class CalibrationStore {
 public:
  explicit CalibrationStore(CalibrationStoreSettings settings) : settings_(std::move(settings)) {}

  /// Names the camera by the frame of its images where the settings do not. Characters that have no
  /// place in a file's name become '_'.
  void setFrame(const std::string& frame_id);

  /// Its file; empty where none is kept, or before setFrame().
  const std::string& file() const { return file_; }

  /// What is known of the camera; nothing where nothing is kept. Throws InputError naming the file
  /// where it cannot be read, or does not hold for images of `camera`.
  std::optional<pf::DepthCalibration> find(const pf::PinholeCamera& camera) const;

  /// Keeps it, in place of what was kept before; one that has no name takes that of the camera.
  /// Throws InputError naming the file where it cannot be written.
  void keep(pf::DepthCalibration calibration) const;

 private:
  CalibrationStoreSettings settings_;
  std::string name_;  // of the camera
  std::string file_;
};

}  // namespace posefusion_ros

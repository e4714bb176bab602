// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posefusion/calibration/depth_calibration.hpp"
#include "posefusion/calibration/view_surface.hpp"

namespace pf {

/// What a map file knows of its depth camera.
struct CalibrationViews {
  PinholeCamera camera;  ///< of the frames
  std::vector<CalibrationView> views;
  std::optional<DepthCalibration> corrected_by;  ///< their depth, already
};

/// The keyframes of a map file that have images; people are out of their depth. Throws InputError
/// naming the file.
CalibrationViews readCalibrationViews(const std::string& map_file);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/core/camera.hpp"

namespace pf {

/// The systematic error of one camera, and what is known of it.
struct DepthCalibration {
  std::string name;      ///< of the camera: its serial number, or what its owner calls it
  PinholeCamera camera;  ///< of the images without lens distortion that the field spans
  DepthField field;
  std::size_t keyframes = 0, pairs = 0;  ///< that it was learned from
  double before_mm = 0, after_mm = 0;    ///< median residual of pairs that were kept out
  double left_per_m = 0;  ///< standard deviation of what the field leaves (1/m); 0: not known
};

/// That depth is corrected by; none: it is as measured.
inline DepthField fieldOf(const std::optional<DepthCalibration>& calibration) {
  return calibration ? calibration->field : DepthField();
}

/// Why a calibration does not hold for images of this camera: a ray would meet the field more than
/// half a cell from where it belongs. Empty when it holds; sizes may differ.
std::string misfit(const DepthCalibration& calibration, const PinholeCamera& camera);

}  // namespace pf

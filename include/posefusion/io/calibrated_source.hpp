// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/frame_source.hpp"

namespace pf {

/// Corrects frames by a calibration file. Not thread safe.
class CalibratedFrames {
 public:
  /// Throws InputError naming the file when it cannot be used.
  explicit CalibratedFrames(const std::string& file);

  /// `straight`: without lens distortion. Throws InputError naming the file for a frame of another
  /// camera.
  RgbdFrame correct(const RgbdFrame& straight);

 private:
  std::string file_;
  DepthCalibration calibration_;
  FrameCorrector corrector_;
};

/// The frames of a recording without lens distortion and with their depth corrected by a
/// calibration file; with no file (empty) the recording as it is. Throws InputError naming the file
/// when it cannot be used; next() does so for frames of another camera.
std::unique_ptr<FrameSource> calibrated(std::unique_ptr<FrameSource> source,
                                        const std::string& calibration_file);

}  // namespace pf

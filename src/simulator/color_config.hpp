// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf::simulator {

/// The colour camera.
struct ColorConfig {
  bool motion_blur = true;
  int samples = 2;       ///< rays a pixel when nothing moves
  int max_samples = 12;  ///< when the picture moves fast
  bool auto_exposure = true;
  double exposure_ms = 16.0;      ///< the first, or the only one
  double max_exposure_ms = 25.0;  ///< then gain
  double gain = 1.0;
  double brightness = 0.34;         ///< mean grey that auto exposure wants, linear
  double noise = 1.0;               ///< times the usual
  double vignette = 0.30;           ///< loss of light in the corners
  double blur_px = 0.55;            ///< lens and colour filter
  int jpeg_quality = 0;             ///< 0: no JPEG
  double rolling_shutter_ms = 0.0;  ///< time from the first to the last row
};

inline void visitFields(ColorConfig& c, FieldVisitor& v) {
  v.flag("motion_blur", c.motion_blur, "integrate over the exposure time");
  v.integer("samples", c.samples, 1, 64, "rays a pixel when nothing moves");
  v.integer("max_samples", c.max_samples, 1, 64, "rays a pixel when the picture moves fast");
  v.flag("auto_exposure", c.auto_exposure, "follow the brightness of the scene in steps");
  v.number("exposure_ms", c.exposure_ms, 0.1, 33.0, "exposure time, the first with auto exposure");
  v.number("max_exposure_ms", c.max_exposure_ms, 0.1, 33.0, "longest time, then gain is raised");
  v.number("gain", c.gain, 0.1, 16.0, "amplification of signal and noise");
  v.number("brightness", c.brightness, 0.01, 1.0, "mean linear grey that auto exposure wants");
  v.number("noise", c.noise, 0.0, 10.0, "photon and read noise, times the usual");
  v.number("vignette", c.vignette, 0.0, 1.0, "loss of light in the corners");
  v.number("blur_px", c.blur_px, 0.0, 5.0, "sigma of lens and colour filter");
  v.integer("jpeg_quality", c.jpeg_quality, 0, 100, "JPEG and back; 0 = none");
  v.number("rolling_shutter_ms", c.rolling_shutter_ms, 0.0, 33.0, "from first to last row");
}

}  // namespace pf::simulator

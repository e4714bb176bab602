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

/// The depth camera: structured light as in the Xtion PRO LIVE.
struct DepthConfig {
  bool noise = true;
  double min_m = 0.5;
  double max_m = 5.0;
  double baseline_m = 0.075;     ///< between projector and infrared camera
  double disparity_steps = 8.0;  ///< steps a pixel of disparity
  double axial = 1.0;            ///< noise along the view, times Nguyen et al. 2012
  double lateral = 1.0;          ///< noise across, times Nguyen et al. 2012
  double distortion = 1.0;       ///< systematic errors, times the usual of an uncalibrated camera
  int specimen = 1;              ///< which camera: each has its own systematic errors
  double dropouts = 1.0;         ///< times the usual
  bool shadow = true;            ///< what the projector does not see has no depth
  double offset_ms = 4.0;        ///< depth is taken so long after the colour
  double jitter_ms = 0.5;        ///< of that
  double misregistration_px = 0.0;  ///< registered depth is so far off, a little to the right
};

inline void visitFields(DepthConfig& c, FieldVisitor& v) {
  v.flag("noise", c.noise, "errors of the depth camera; off: exact depth, rounded to a millimetre");
  v.number("min_m", c.min_m, 0.0, 10.0, "nearest depth");
  v.number("max_m", c.max_m, 0.1, 60.0, "farthest depth");
  v.number("baseline_m", c.baseline_m, 0.001, 1.0, "between projector and infrared camera");
  v.number("disparity_steps", c.disparity_steps, 0.5, 1024.0, "steps a pixel of disparity");
  v.number("axial", c.axial, 0.0, 10.0, "noise along the view, times Nguyen et al. 2012");
  v.number("lateral", c.lateral, 0.0, 10.0, "noise across the view, times Nguyen et al. 2012");
  v.number("distortion", c.distortion, 0.0, 20.0, "systematic errors of depth, times the usual");
  v.integer("specimen", c.specimen, 0, 1000000, "each camera has its own systematic errors");
  v.number("dropouts", c.dropouts, 0.0, 10.0, "pixels without depth, times the usual");
  v.flag("shadow", c.shadow, "no depth where the projector does not see");
  v.number("offset_ms", c.offset_ms, -33.0, 33.0, "depth stamp after the colour stamp");
  v.number("jitter_ms", c.jitter_ms, 0.0, 10.0, "spread of that offset");
  v.number("misregistration_px", c.misregistration_px, -20.0, 20.0, "shift of registered depth");
}

}  // namespace pf::simulator

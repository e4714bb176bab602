// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/config/fields.hpp"

namespace pf::simulator {

/// The depth camera; the defaults are those of an Xtion PRO LIVE.
struct DepthConfig {
  std::string kind = "structured_light";
  bool noise = true;
  double min_m = 0.5;
  double max_m = 8.0;
  double baseline_m = 0.075;     ///< between projector and infrared camera
  double disparity_steps = 8.0;  ///< steps a pixel of disparity
  double axial = 1.0;            ///< noise along the view, times the usual of the kind
  double lateral = 1.0;          ///< noise across, times Nguyen et al. 2012
  double distortion = 1.0;     ///< smooth systematic errors, times the usual of a camera as bought
  int specimen = 1;            ///< which camera: each has its own systematic errors
  double stripe_mm = 0.0;      ///< most that a vertical band is off at 2 m; with z^2
  int stripe_px = 40;          ///< width of a band
  double bowl_mm = 0.0;        ///< error in the corners at 2 m; with the square of the radius
  int bowl_power = 2;          ///< of the distance that it grows with: 1 or 2
  double drift_mm = 0.0;       ///< error of a cold camera at 2 m, all over; with z^2
  double drift_percent = 0.0;  ///< by so much the smooth errors of a cold camera are larger
  double drift_s = 240.0;      ///< both fade with this time constant; cold at time 0
  double tof_brightness_mm = 10.0;  ///< time of flight: error of what hardly comes back
  double tof_wiggling_mm = 4.0;     ///< time of flight: height of the error with a period of 0.47 m
  double stereo_projector = 1.0;    ///< stereo: contrast of the pattern, times the usual; 0: off
  double dropouts = 1.0;            ///< times the usual
  bool shadow = true;               ///< what the projector does not see has no depth
  double offset_ms = 4.0;           ///< depth is taken so long after the colour
  double jitter_ms = 0.5;           ///< of that
  double misregistration_px = 0.0;  ///< registered depth is so far off, a little to the right
};

inline void visitFields(DepthConfig& c, FieldVisitor& v) {
  v.flag("noise", c.noise, "errors of the depth camera; off: exact depth, rounded to a millimetre");
  v.choice("kind", c.kind, {"structured_light", "time_of_flight", "active_stereo"},
           "how the camera measures");
  v.number("min_m", c.min_m, 0.0, 10.0, "nearest depth");
  v.number("max_m", c.max_m, 0.1, 60.0, "farthest depth");
  v.number("baseline_m", c.baseline_m, 0.001, 1.0, "between projector and infrared camera");
  v.number("disparity_steps", c.disparity_steps, 0.5, 1024.0, "steps a pixel of disparity");
  v.number("axial", c.axial, 0.0, 10.0, "noise along the view, times the usual of the kind");
  v.number("lateral", c.lateral, 0.0, 10.0, "noise across the view, times Nguyen et al. 2012");
  v.number("distortion", c.distortion, 0.0, 20.0, "smooth systematic errors, times the usual");
  v.integer("specimen", c.specimen, 0, 1000000,
            "each camera has its own systematic errors; not set: that of the scene's seed");
  v.number("stripe_mm", c.stripe_mm, 0.0, 100.0, "most that a vertical band is off at 2 m");
  v.integer("stripe_px", c.stripe_px, 1, 10000, "width of a band");
  v.number("bowl_mm", c.bowl_mm, -500.0, 500.0, "error in the corners at 2 m");
  v.integer("bowl_power", c.bowl_power, 1, 2, "of the distance that it grows with");
  v.number("drift_mm", c.drift_mm, -500.0, 500.0, "error of a cold camera at 2 m, all over");
  v.number("drift_percent", c.drift_percent, -100.0, 1000.0,
           "by so much the smooth errors of a cold camera are larger");
  v.number("drift_s", c.drift_s, 1.0, 36000.0, "time constant of warming up; cold at time 0");
  v.number("tof_brightness_mm", c.tof_brightness_mm, -200.0, 200.0,
           "time of flight: error of a surface that hardly returns light");
  v.number("tof_wiggling_mm", c.tof_wiggling_mm, 0.0, 200.0,
           "time of flight: height of the periodic error");
  v.number("stereo_projector", c.stereo_projector, 0.0, 100.0,
           "stereo: contrast of the pattern, times the usual; 0 = off");
  v.number("dropouts", c.dropouts, 0.0, 10.0, "pixels without depth, times the usual");
  v.flag("shadow", c.shadow, "no depth where the projector does not see");
  v.number("offset_ms", c.offset_ms, -33.0, 33.0, "depth stamp after the colour stamp");
  v.number("jitter_ms", c.jitter_ms, 0.0, 10.0, "spread of that offset");
  v.number("misregistration_px", c.misregistration_px, -20.0, 20.0, "shift of registered depth");
}

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of frame-to-model tracking.
struct TrackingConfig {
  double max_distance_m = 0.10;
  double max_normal_angle_rad = 0.7;
  double photometric_sigma = 12.0;
  bool rotation_prealignment = true;
  int max_iterations = 12;
  double min_view_fraction = 0.10;
  double min_valid_fraction = 0.03;
  double min_inlier_fraction = 0.4;
  double lost_after_s = 0.333;
  double sure_to_return = 0.95;
};

inline void visitFields(TrackingConfig& c, FieldVisitor& v) {
  v.number("max_distance_m", c.max_distance_m, 1e-3, 10.0,
           "largest distance of a matched pair, or three sigmas of its depth where that is more");
  v.number("max_normal_angle_rad", c.max_normal_angle_rad, 0.01, 3.14,
           "largest angle between the normals of a matched pair");
  v.number("photometric_sigma", c.photometric_sigma, 0.0, 1000.0,
           "standard deviation of a grey level; 0 = geometry only");
  v.flag("rotation_prealignment", c.rotation_prealignment,
         "align small images by rotation alone first");
  v.integer("max_iterations", c.max_iterations, 1, 1000, "Gauss-Newton steps on each level");
  v.number("min_view_fraction", c.min_view_fraction, 0.0, 1.0,
           "least part of the image that must have depth beside people: through a gap, a frame "
           "slides along the wall behind");
  v.number("min_valid_fraction", c.min_valid_fraction, 0.0, 1.0,
           "least part of the image that must have depth and model");
  v.number("min_inlier_fraction", c.min_inlier_fraction, 0.0, 1.0,
           "least part of those that must agree");
  v.number(
      "lost_after_s", c.lost_after_s, 0.0, 100.0,
      "so long a row of untrusted frames, and tracking counts as lost (s, counted in frames at "
      "the pace of the camera: of blurred ones only those that the gate lets through)");
  v.number("sure_to_return", c.sure_to_return, 0.5, 0.999999,
           "how sure (a probability) a place must be to bring a lost camera back, or to close a "
           "loop");
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/config/fields.hpp"

namespace pf {

/// Settings of the pose graph.
struct GraphConfig {
  double keyframe_distance_m = 0.3;
  double keyframe_angle_rad = 0.26;
  double odometry_sigma_m = 0.02;
  double odometry_sigma_rad = 0.01;
  double loop_sigma_m = 0.01;
  double loop_sigma_rad = 0.005;
  double robust_scale = 3.0;
  double max_chi_square = 22.46;
  int max_iterations = 50;
  int keyframes_at_a_place = 8;
};

inline void visitFields(GraphConfig& c, FieldVisitor& v) {
  v.number("keyframe_distance_m", c.keyframe_distance_m, 0.01, 100.0,
           "a frame so far from the last keyframe becomes one");
  v.number("keyframe_angle_rad", c.keyframe_angle_rad, 0.01, 3.14, "the same of the rotation");
  v.number("odometry_sigma_m", c.odometry_sigma_m, 1e-5, 10.0,
           "drift between two keyframes that tracking does not know of, added to its covariance");
  v.number("odometry_sigma_rad", c.odometry_sigma_rad, 1e-5, 3.0, "the same of the rotation");
  v.number("loop_sigma_m", c.loop_sigma_m, 1e-5, 10.0,
           "error of a loop constraint that its covariance does not know of");
  v.number("loop_sigma_rad", c.loop_sigma_rad, 1e-5, 3.0, "the same of the rotation");
  v.number("robust_scale", c.robust_scale, 0.1, 1e3,
           "loop constraints count less beyond so many standard deviations (Cauchy)");
  v.number("max_chi_square", c.max_chi_square, 1.0, 1e6,
           "largest squared error, in variances, of a constraint after optimising; above it a loop "
           "is refused (22.46: 99.9 % of true ones pass)");
  v.integer("max_iterations", c.max_iterations, 1, 10000, "Levenberg-Marquardt steps");
  v.integer("keyframes_at_a_place", c.keyframes_at_a_place, 0, 100000,
            "of more keyframes than this that see about the same, the later are retired after some "
            "time: their pictures go, what hangs on them follows an older one; 0: none is");
}

}  // namespace pf

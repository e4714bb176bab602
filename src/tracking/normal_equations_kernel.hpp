// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "posefusion/core/depth_sensor.hpp"

/// The inner loop of tracking on plain arrays: no Eigen, no OpenCV, so that it can be compiled once
/// per instruction set (core/parallel.hpp).
namespace pf::kernel {

struct Points {
  const float *x, *y, *z, *nx, *ny, *nz, *intensity, *weight;
};

struct Image {
  const float *depth, *nx, *ny, *nz, *intensity;
  int width, height;
  float fx, fy, cx, cy;
};

struct Motion {
  float r[9];  ///< rotation, row by row
  float t[3];
};

/// A pair agrees when its distance can be explained by noise: so many standard deviations of the
/// measured depth. Pairs that do not agree still pull, weakly.
constexpr float kInlierSigmas = 3.0F;

/// The two points of a pair are not farther apart than this (m); `sigma` (m): of the depth.
constexpr float mostApart(float max_distance, float sigma) {
  const float by_noise = kInlierSigmas * sigma;
  return by_noise < max_distance ? max_distance : by_noise;
}

struct Gates {
  float max_distance, min_cosine, robust_scale, inverse_photometric_sigma;
  float brightness_gain, brightness_offset;
  DepthSensor sensor;
};

/// Places of the sums: 0-20 upper triangle of H, 21-26 g, then these.
enum Sum : int {
  kGeometricError = 27,
  kPhotometricError,
  kBrightnessWeight,  ///< sum w, then of w m, w y, w m m, w m y: m the model's grey level, y the
                      ///< frame's
  kBrightnessM,
  kBrightnessY,
  kBrightnessMM,
  kBrightnessMY,
  kCost,
  kCostWeight,
  kCandidates,
  kInliers,
  kPhotometricInliers,
  kSeenThrough,
  kSums
};

/// Adds the sums over points [begin, end), a whole number of groups of 16, to `sums`.
void accumulate(const Points& points, const Image& image, const Motion& motion, const Gates& gates,
                std::size_t begin, std::size_t end, double* sums);

}  // namespace pf::kernel

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

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

struct Gates {
  float max_distance, min_cosine, robust_scale, inverse_photometric_sigma, brightness_offset;
};

/// Sums: 0-20 upper triangle of H, 21-26 g, 27 geometric error, 28 photometric error, 29 weighted
/// photometric residuals, 30 their weights, 31 robust error, 32 candidates, 33 inliers,
/// 34 photometric inliers.
constexpr int kSums = 35;

/// Adds the sums over points [begin, end), a whole number of groups of 16, to `sums`.
void accumulate(const Points& points, const Image& image, const Motion& motion, const Gates& gates,
                std::size_t begin, std::size_t end, double* sums);

}  // namespace pf::kernel

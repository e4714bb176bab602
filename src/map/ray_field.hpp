// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/core/camera.hpp"

namespace pf {

/// The four cubic B-splines that are not zero at a place along one axis of a field, and their
/// slopes by that place.
struct SplineWeights {
  int first;
  float weight[4], slope[4];

  /// `place`: 0..1 over the image; others count as on its border. `intervals`: between nodes.
  SplineWeights(float place, int intervals) {
    const auto n = static_cast<float>(intervals);
    const float at = std::min(std::max(place, 0.0F), 1.0F) * n;
    first = std::min(static_cast<int>(at), intervals - 1);
    const float t = at - static_cast<float>(first), s = 1 - t;
    const float by = 0.5F * n;
    weight[0] = s * s * s / 6;
    weight[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
    weight[2] = (3 * s * s * s - 6 * s * s + 4) / 6;
    weight[3] = t * t * t / 6;
    slope[0] = -by * s * s;
    slope[1] = by * (3 * t * t - 4 * t);
    slope[2] = -by * (3 * s * s - 4 * s);
    slope[3] = by * t * t;
  }
};

/// A depth field over the rays of a camera, in floats, for loops over surfels: a value, so that a
/// loop may have its own.
class RayField {
 public:
  /// `nodes`: the field's in floats; they must outlive it.
  RayField(const DepthField& field, const PinholeCamera& camera, const std::vector<float>& nodes)
      : fx_(static_cast<float>(camera.fx)),
        fy_(static_cast<float>(camera.fy)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        width_(static_cast<float>(camera.width)),
        height_(static_cast<float>(camera.height)),
        columns_(field.columns()),
        rows_(field.rows()),
        nodes_(nodes.data()) {}

  /// 1/m, and its slopes by the ray's x/z and y/z.
  struct Value {
    float d, by_x, by_y;
  };

  /// For the ray (x, y, 1).
  Value at(float x, float y) const {
    const SplineWeights across((fx_ * x + cx_ + 0.5F) / width_, columns_ - 3);
    const SplineWeights down((fy_ * y + cy_ + 0.5F) / height_, rows_ - 3);
    Value sum{0, 0, 0};
    for (int i = 0; i < 4; ++i) {
      const int k = (down.first + i) * columns_ + across.first;
      const float a = nodes_[k], b = nodes_[k + 1], c = nodes_[k + 2], d = nodes_[k + 3];
      const float value =
          across.weight[0] * a + across.weight[1] * b + across.weight[2] * c + across.weight[3] * d;
      const float slope =
          across.slope[0] * a + across.slope[1] * b + across.slope[2] * c + across.slope[3] * d;
      sum.d += down.weight[i] * value;
      sum.by_x += down.weight[i] * slope;
      sum.by_y += down.slope[i] * value;
    }
    return {sum.d, sum.by_x * fx_ / width_, sum.by_y * fy_ / height_};
  }

  bool isInside(float x, float y) const {
    const float u = fx_ * x + cx_, v = fy_ * y + cy_;
    return (u > -0.5F) & (v > -0.5F) & (u < width_ - 0.5F) & (v < height_ - 0.5F);
  }

 private:
  float fx_, fy_, cx_, cy_, width_, height_;
  int columns_, rows_;
  const float* nodes_;
};

}  // namespace pf

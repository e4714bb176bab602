// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/calibration/cubic_splines.hpp"
#include "posefusion/calibration/depth_field.hpp"
#include "posefusion/core/camera.hpp"

namespace pf {

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
    const CubicSplines<float> across((fx_ * x + cx_ + 0.5F) / width_, columns_);
    const CubicSplines<float> down((fy_ * y + cy_ + 0.5F) / height_, rows_);
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

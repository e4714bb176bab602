// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace pf {

/// The line through a surfel along its normal.
struct NormalLine {
  Eigen::Vector3f from, along;

  /// Around the line this far both ways, and so much more.
  Eigen::AlignedBox3f box(float length, float margin) const { return box(-length, length, margin); }

  /// Around a part of the line, and so much more.
  Eigen::AlignedBox3f box(float begin, float end, float margin) const {
    Eigen::AlignedBox3f box(Eigen::Vector3f(from + begin * along));
    box.extend(from + end * along);
    return {box.min() - Eigen::Vector3f::Constant(margin),
            box.max() + Eigen::Vector3f::Constant(margin)};
  }

  /// Whether it meets the disc, which faces the way of the line as `facing` (a cosine) demands; and
  /// how far along.
  bool meets(const Eigen::Vector3f& center, const Eigen::Vector3f& normal, float radius,
             float facing, float& at) const {
    const float cosine = normal.dot(along);
    if (cosine < facing) return false;
    at = normal.dot(center - from) / cosine;
    return (from + at * along - center).squaredNorm() <= radius * radius;
  }
};

}  // namespace pf

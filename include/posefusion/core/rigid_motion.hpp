// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace pf {

/// A rigid motion in plain floats, for loops over surfels.
class RigidMotion {
 public:
  explicit RigidMotion(const Eigen::Isometry3d& T) {
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) r_[3 * row + col] = static_cast<float>(T(row, col));
      t_[row] = static_cast<float>(T(row, 3));
    }
  }

  void point(float x, float y, float z, float& ox, float& oy, float& oz) const {
    direction(x, y, z, ox, oy, oz);
    ox += t_[0];
    oy += t_[1];
    oz += t_[2];
  }

  void direction(float x, float y, float z, float& ox, float& oy, float& oz) const {
    ox = r_[0] * x + r_[1] * y + r_[2] * z;
    oy = r_[3] * x + r_[4] * y + r_[5] * z;
    oz = r_[6] * x + r_[7] * y + r_[8] * z;
  }

  const float* rotation() const { return r_; }  ///< row by row
  const float* translation() const { return t_; }

 private:
  float r_[9];
  float t_[3];
};

}  // namespace pf

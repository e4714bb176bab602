// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <optional>

namespace pf {

/// A piece of plane in a depth image: planes are linear in inverse depth.
struct InversePlane {
  double w = 0;               ///< inverse depth (1/m) in the middle of the window
  double by_u = 0, by_v = 0;  ///< how it changes with the pixel (1/m)
  double variance = 0;        ///< of what the plane leaves of the depths, (1/m)^2
  double support = 0;         ///< w is as sure as the mean of so many depths
};

/// Sums for the plane that fits the depths of a window best. Pixels count from the window's middle.
class InversePlaneSums {
 public:
  void add(double du, double dv, double inverse_1_m) {
    n_ += 1;
    u_ += du;
    v_ += dv;
    uu_ += du * du;
    uv_ += du * dv;
    vv_ += dv * dv;
    w_ += inverse_1_m;
    wu_ += inverse_1_m * du;
    wv_ += inverse_1_m * dv;
    ww_ += inverse_1_m * inverse_1_m;
  }

  double count() const { return n_; }

  /// Nothing where the depths lie on one line.
  std::optional<InversePlane> fit() const {
    Eigen::Matrix3d A;
    A << n_, u_, v_, u_, uu_, uv_, v_, uv_, vv_;
    const Eigen::Vector3d b(w_, wu_, wv_);
    const double determinant = A.determinant();
    if (!(determinant > 1e-9 * n_ * n_ * n_)) return std::nullopt;
    const Eigen::Matrix3d inverse = A.inverse();
    const Eigen::Vector3d x = inverse * b;
    return InversePlane{x[0], x[1], x[2], std::max(0.0, (ww_ - x.dot(b)) / n_),
                        1.0 / inverse(0, 0)};
  }

 private:
  double n_ = 0, u_ = 0, v_ = 0, uu_ = 0, uv_ = 0, vv_ = 0, w_ = 0, wu_ = 0, wv_ = 0, ww_ = 0;
};

}  // namespace pf

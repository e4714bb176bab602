// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace pf {

/// The four cubic B-splines that are not zero at a place along one axis of a field, and their
/// derivatives by that place (de Boor, "A Practical Guide to Splines", 1978; uniform knots).
/// Without branches, so that loops over it use vectors.
template <typename Real>
struct CubicSplines {
  int first;
  Real weight[4], slope[4];

  /// `place`: 0..1 over the image; others count as on its border. `count`: of nodes, 4 or more.
  CubicSplines(Real place, int count) {
    const int intervals = count - 3;
    const auto n = static_cast<Real>(intervals);
    const Real at = std::min(std::max(place, Real(0)), Real(1)) * n;
    first = std::min(static_cast<int>(at), intervals - 1);
    const Real t = at - static_cast<Real>(first), s = 1 - t;
    weight[0] = s * s * s / 6;
    weight[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
    weight[2] = (3 * s * s * s - 6 * s * s + 4) / 6;
    weight[3] = t * t * t / 6;
    slope[0] = -n * s * s / 2;
    slope[1] = n * (3 * t * t - 4 * t) / 2;
    slope[2] = -n * (3 * s * s - 4 * s) / 2;
    slope[3] = n * t * t / 2;
  }
};

}  // namespace pf

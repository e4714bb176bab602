// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "posefusion/pose/skeleton.hpp"
#include "shape.hpp"

namespace pf::synthetic {

/// The walking person at one moment: solids and the joints inside them, room frame, metres.
struct Figure {
  std::vector<Shape> shapes;
  std::array<Eigen::Vector3f, kJointCount> joints;
};

/// Walks round the carpet in front of the camera at about 0.8 m/s, for ever. `seed` picks where on
/// its way it is at time 0.
Figure figureAt(double time_s, std::uint32_t seed);

}  // namespace pf::synthetic

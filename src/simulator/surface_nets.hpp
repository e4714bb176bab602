// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace pf::simulator {

/// A closed surface as triangles.
struct Polygonised {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The zero level of a distance within a box by naive surface nets (Gibson 1998) on cells of
/// `cell_m`.
Polygonised polygonise(const std::function<float(const Eigen::Vector3f&)>& distance,
                       const Eigen::AlignedBox3f& box, float cell_m);

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#include "room_fit.hpp"

#include <algorithm>

namespace posefusion_ros {
namespace {

constexpr double kLeftOut = 0.01;
constexpr double kMostTilt_rad = 0.61;  // of a map that does not know of gravity

Eigen::Vector3f positionOf(const SurfelPoint& s) { return {s.x, s.y, s.z}; }

}  // namespace

Eigen::AlignedBox3f boundsOf(const std::vector<SurfelPoint>& surfels) {
  Eigen::AlignedBox3f box;
  if (surfels.empty()) return box;
  const auto cut = static_cast<std::ptrdiff_t>(kLeftOut * static_cast<double>(surfels.size()));
  std::vector<float> values(surfels.size());
  Eigen::Vector3f low, high;
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(surfels.begin(), surfels.end(), values.begin(),
                   [axis](const SurfelPoint& s) { return positionOf(s)[axis]; });
    std::nth_element(values.begin(), values.begin() + cut, values.end());
    low[axis] = values[static_cast<std::size_t>(cut)];
    std::nth_element(values.begin(), values.end() - 1 - cut, values.end());
    high[axis] = *(values.end() - 1 - cut);
  }
  return {low, high};
}

std::optional<pf::Levels> floorOf(const std::vector<SurfelPoint>& surfels) {
  pf::MapPoints points;
  for (const SurfelPoint& s : surfels) {
    points.x.push_back(s.x);
    points.y.push_back(s.y);
    points.z.push_back(s.z);
    points.nx.push_back(s.normal_x);
    points.ny.push_back(s.normal_y);
    points.nz.push_back(s.normal_z);
  }
  return pf::findLevels(pf::orientedPoints(points), Eigen::Vector3d::UnitZ(), kMostTilt_rad);
}

}  // namespace posefusion_ros

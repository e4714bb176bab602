// SPDX-License-Identifier: BSD-3-Clause
#include "room_fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace posefusion_ros {
namespace {

constexpr double kLeftOut = 0.01;
constexpr std::size_t kFewest = 50;
constexpr float kFacesUp = 0.82F;      // cosine: 35 degrees
constexpr float kFacesAlong = 0.966F;  // 15 degrees, once the plane is known roughly
constexpr float kBin_m = 0.04F;
constexpr double kLargePart = 0.25;  // of the fullest bin
constexpr int kRounds = 4;

Eigen::Vector3f positionOf(const SurfelPoint& s) { return {s.x, s.y, s.z}; }
Eigen::Vector3f normalOf(const SurfelPoint& s) { return {s.normal_x, s.normal_y, s.normal_z}; }

/// The height of the lowest bin that holds many of those that face along `normal`.
std::optional<float> lowestLargeHeight(const std::vector<SurfelPoint>& surfels,
                                       const Eigen::Vector3f& normal, float cosine) {
  std::map<int, std::size_t> bins;
  std::size_t fullest = 0;
  for (const SurfelPoint& s : surfels) {
    if (normalOf(s).dot(normal) < cosine) continue;
    const float height = positionOf(s).dot(normal);
    fullest = std::max(fullest, ++bins[static_cast<int>(std::floor(height / kBin_m))]);
  }
  for (const auto& [bin, count] : bins) {
    if (count < kFewest || static_cast<double>(count) < kLargePart * static_cast<double>(fullest))
      continue;
    return (static_cast<float>(bin) + 0.5F) * kBin_m;
  }
  return std::nullopt;
}

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

std::optional<FloorPlane> floorOf(const std::vector<SurfelPoint>& surfels) {
  FloorPlane plane;
  for (int round = 0; round < kRounds; ++round) {
    const float cosine = round == 0 ? kFacesUp : kFacesAlong;
    const auto height = lowestLargeHeight(surfels, plane.normal, cosine);
    if (!height) return std::nullopt;
    Eigen::Vector3f normals = Eigen::Vector3f::Zero(), positions = Eigen::Vector3f::Zero();
    std::size_t count = 0;
    // At first the plane may be tilted by much: its surfels lie at many heights.
    const float reach = kBin_m * static_cast<float>(round == 0 ? 8 : 1);
    for (const SurfelPoint& s : surfels) {
      if (normalOf(s).dot(plane.normal) < cosine ||
          std::abs(positionOf(s).dot(plane.normal) - *height) > reach) {
        continue;
      }
      normals += normalOf(s);
      positions += positionOf(s);
      ++count;
    }
    plane.normal = normals.normalized();
    plane.height = positions.dot(plane.normal) / static_cast<float>(count);
  }
  return plane;
}

}  // namespace posefusion_ros

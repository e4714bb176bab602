// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/visibility.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace pf {
namespace {

// Outside the picture by so much (pixels) still counts as in view: fusion rounds to whole pixels.
constexpr double kMargin_px = 1.0;
// Users of the list transform surfels into the camera's frame in floats, whose error is below this
// up to kilometres from the origin.
constexpr double kRounding_m = 1e-3;

/// A half space in the map frame: inside where normal . x + offset >= 0 (m).
struct HalfSpace {
  Eigen::Vector3d normal;
  double offset;

  /// False when all of the box is farther than `margin` outside.
  bool touches(const Eigen::AlignedBox3d& box, double margin) const {
    const Eigen::Vector3d inmost =
        (normal.array() >= 0).select(box.max().array(), box.min().array());
    return normal.dot(inmost) + offset >= -margin;
  }
};

/// The frustum of a camera, from its own plane to max_depth_m.
std::array<HalfSpace, 6> frustumOf(const PinholeCamera& c, const Eigen::Isometry3d& T_map_camera,
                                   double max_depth_m) {
  // Each is the side of the picture as a plane through the camera: u >= -margin is
  // fx x + (cx + margin) z >= 0, and so on.
  const double right = c.width - 1 - c.cx + kMargin_px, bottom = c.height - 1 - c.cy + kMargin_px;
  const std::array<Eigen::Vector3d, 6> normals = {Eigen::Vector3d(c.fx, 0, c.cx + kMargin_px),
                                                  Eigen::Vector3d(-c.fx, 0, right),
                                                  Eigen::Vector3d(0, c.fy, c.cy + kMargin_px),
                                                  Eigen::Vector3d(0, -c.fy, bottom),
                                                  Eigen::Vector3d(0, 0, 1),
                                                  Eigen::Vector3d(0, 0, -1)};
  std::array<HalfSpace, 6> sides;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Eigen::Vector3d n = T_map_camera.linear() * normals[k].normalized();
    sides[k].normal = n;
    sides[k].offset = -n.dot(T_map_camera.translation());
  }
  sides[5].offset =
      max_depth_m > 0 ? sides[5].offset + max_depth_m : std::numeric_limits<double>::infinity();
  return sides;
}

}  // namespace

std::vector<std::uint32_t> visibleBlocks(const SurfelMap& map, const PinholeCamera& camera,
                                         const MapPose& pose, double max_depth_m) {
  const auto sides = frustumOf(camera, pose.T_map_camera, max_depth_m);
  std::vector<std::uint32_t> visible;
  for (std::uint32_t i = 0; i < map.blocks().size(); ++i) {
    const SurfelBlock& block = map.blocks()[i];
    if (block.fragment != pose.fragment || block.surfels.size() == 0) continue;
    const Eigen::AlignedBox3d bounds = block.bounds.cast<double>();
    const double margin = block.largest_radius + kRounding_m;
    if (std::all_of(sides.begin(), sides.end(),
                    [&](const HalfSpace& s) { return s.touches(bounds, margin); })) {
      visible.push_back(i);
    }
  }
  return visible;
}

std::vector<SurfelRange> rangesOf(const SurfelMap& map, const std::vector<std::uint32_t>& blocks) {
  std::vector<SurfelRange> ranges;
  for (const std::uint32_t block : blocks) {
    const auto size = static_cast<std::uint32_t>(map.blocks()[block].surfels.size());
    for (std::uint32_t begin = 0; begin < size; begin += kRangeSurfels) {
      ranges.push_back({block, begin, std::min(size, begin + kRangeSurfels)});
    }
  }
  return ranges;
}

}  // namespace pf

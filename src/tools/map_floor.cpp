// SPDX-License-Identifier: BSD-3-Clause
#include "map_floor.hpp"

#include <utility>

#include "map_surfels.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/grid/floor.hpp"
#include "posefusion/map/stable_surfels.hpp"

namespace pf {
namespace {

FloorMap floorMapOf(const std::string& file) {
  const MapReader reader(file);
  const MapContent content = reader.content();
  const SurfelMap map = mapOf(reader, content, file);
  const Eigen::Isometry3d T_world_map = worldOf(content);
  FloorMap out;
  out.T_floor_world = floorFrame(stableSurfels(map, T_world_map));
  const Eigen::Isometry3d T_floor_map = out.T_floor_world * T_world_map;
  out.surfels = stableSurfels(map, T_floor_map);
  forEachKeyframe(map, content.camera, content.keyframes, [&](const SeenPoints& seen) {
    const Eigen::Isometry3f T = T_floor_map.cast<float>();
    SeenPoints level{T * seen.from, seen.points};
    for (Eigen::Vector3f& p : level.points) p = T * p;
    out.seen.push_back(std::move(level));
  });
  return out;
}

}  // namespace

double FloorMap::leaning_rad() const { return angleOf(T_floor_world); }

FloorMap readFloorMap(const std::string& file) {
  try {
    return floorMapOf(file);
  } catch (const InputError& error) {
    const std::string text = error.what();
    throw InputError(text.rfind(file, 0) == 0 ? text : file + ": " + text);
  }
}

OccupancyGrid gridOf(const FloorMap& map, const GridConfig& config) {
  GridMaker maker(map.surfels, config);
  for (const SeenPoints& seen : map.seen) maker.add(seen);
  return maker.grid();
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "map_surfels.hpp"

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/map/stable_surfels.hpp"

namespace pf {

SurfelMap mapOf(const MapReader& reader, const MapContent& content, const std::string& file) {
  Config config = settingsOf(content, file);
  config.map.memory_limit_mb = 1e6;
  SurfelMap map(config.map);
  map.restore(reader.surfels(), content.frame);
  return map;
}

Eigen::Isometry3d worldOf(const MapContent& content) {
  return placeOf(content).value_or(bodyFromOptical());
}

SurfelArrays readStableSurfels(const std::string& file) {
  const MapReader reader(file);
  const MapContent content = reader.content();
  return stableSurfels(mapOf(reader, content, file), worldOf(content));
}

}  // namespace pf

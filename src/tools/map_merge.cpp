// SPDX-License-Identifier: BSD-3-Clause
#include "map_merge.hpp"

#include <cstdio>

#include "map_output.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/slam/map_merge.hpp"

namespace pf {
namespace {

// The limit of the settings is for mapping: here it would leave surfels out.
constexpr double kAnyMemory_mb = 1e6;

}  // namespace

void mergeMaps(const std::string& first, const std::string& second, const std::string& output) {
  requireNew(output);
  const Config settings = settingsOf(MapReader(first).content(), first);
  const Config of_second = settingsOf(MapReader(second).content(), second);
  if (depthSensorOf(settings).kind != depthSensorOf(of_second).kind) {
    throw InputError(second + ": is of a depth camera of another kind (sensor.kind: " +
                     of_second.sensor.kind + ") than " + first + " (" + settings.sensor.kind + ")");
  }
  MergedMap merged = merge({first, readSavedMap(first)}, {second, readSavedMap(second)}, settings);
  Config roomy = settings;
  roomy.map.memory_limit_mb = kAnyMemory_mb;
  const PinholeCamera camera = merged.map.camera;
  Mapper mapper(roomy);
  mapper.load(std::move(merged.map), MapUse::extend);
  writeMap(mapper, camera, settings, output);
  std::printf("%s: %s\n", output.c_str(), merged.text().c_str());
}

}  // namespace pf

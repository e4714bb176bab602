// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/map_merge.hpp"

#include <algorithm>
#include <cstdio>
#include <set>
#include <utility>

#include "map_merger.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/slam/map_append.hpp"

namespace pf {
namespace {

constexpr double kAnyMemory_mb = 1e6;  // the limit is for mapping: here it would drop surfels

/// The map as a mapper with these settings has it, with its depth corrected.
SavedMap loaded(NamedMap named, const std::optional<DepthCalibration>& calibration,
                const Config& config) {
  try {
    const PinholeCamera camera = named.map.camera;
    Mapper mapper(config);
    if (calibration) mapper.calibrate(*calibration);
    mapper.load(std::move(named.map), MapUse::extend);
    return mapper.saved(camera);
  } catch (const InputError& error) {
    throw InputError(named.name + ": " + error.what());
  }
}

/// Fragments that only keyframes from `border` on are in.
std::size_t fragmentsApart(const std::vector<Keyframe>& keyframes, std::size_t border) {
  std::set<int> first, second;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    (i < border ? first : second).insert(keyframes[i].fragment);
  }
  return static_cast<std::size_t>(std::count_if(
      second.begin(), second.end(), [&](int fragment) { return first.count(fragment) == 0; }));
}

}  // namespace

MergedMap merge(NamedMap first, NamedMap second, const Config& settings) {
  const std::string names = second.name + " does not become one with " + first.name + ": ";
  const PinholeCamera camera = first.map.camera;
  if (!isSameCamera(camera, second.map.camera)) {
    throw InputError(names + "they are of different cameras (" + describe(second.map.camera) +
                     "; " + describe(camera) + ")");
  }
  Config config = settings;
  config.map.memory_limit_mb = kAnyMemory_mb;
  config.graph.keyframes_at_a_place = 0;  // pictures of both are wanted until they are one
  const auto calibration = betterKnown(first.map, second.map);
  SavedMap a = loaded(std::move(first), calibration, config);
  SavedMap b = loaded(std::move(second), calibration, config);
  const std::size_t border = a.keyframes.size(),
                    surfels = surfelsIn(a.surfels) + surfelsIn(b.surfels);
  Mapper mapper(config);
  mapper.load(appended(std::move(a), std::move(b)), MapUse::extend);
  MergedMap merged;
  const std::string reason = MapMerger(mapper, config, static_cast<int>(border)).merge(merged);
  if (!reason.empty()) throw InputError(names + reason);
  merged.map = mapper.saved(camera);
  merged.apart = fragmentsApart(merged.map.keyframes, border);
  merged.layers = surfels - surfelsIn(merged.map.surfels);
  return merged;
}

std::string MergedMap::text() const {
  char line[240];
  std::snprintf(line, sizeof line,
                "merged: %zu pairs of keyframes recognised, %zu agree; %zu loops between the maps, "
                "%zu double surfels removed, %zu fragments of the second still apart",
                recognised, agreeing, loops, layers, apart);
  return line;
}

}  // namespace pf

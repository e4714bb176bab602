// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "evaluate.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/evaluation/thing_check.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/mask_folders.hpp"
#include "posefusion/run/sequence_facts.hpp"
#include "true_surface.hpp"

namespace pf {
namespace {

nlohmann::ordered_json toJson(const RemainsScore& score,
                              const std::optional<ThingMaskScore>& masks) {
  nlohmann::ordered_json out = {
      {"surfels", score.surfels}, {"remains", score.remains()}, {"share", score.share()}};
  for (const ThingRemains& thing : score.things) {
    out["things"].push_back({{"name", thing.name},
                             {"at_old_places", thing.at_old_places},
                             {"on_the_way", thing.on_the_way}});
  }
  if (!masks) return out;
  out["masks"] = {{"frames", masks->frames},
                  {"masked_of_moving_things", masks->masked_things},
                  {"masked_of_what_stands", masks->masked_still}};
  return out;
}

void print(const RemainsScore& score, const std::optional<ThingMaskScore>& masks) {
  std::printf("stable surfels           %zu\n", score.surfels);
  std::printf("remains of things        %zu, %.3f %%\n", score.remains(), 100 * score.share());
  for (const ThingRemains& thing : score.things) {
    std::printf("  %-22s %zu at old places, %zu on the way\n", thing.name.c_str(),
                thing.at_old_places, thing.on_the_way);
  }
  if (!masks) return;
  std::printf(
      "masked                   %.1f %% of what moves, %.3f %% of what stands (%d frames)\n",
      100 * masks->masked_things, 100 * masks->masked_still, masks->frames);
}

}  // namespace

void evaluateThings(const std::string& run, const std::string& sequence, bool json) {
  const auto things = loadThings(sequence);
  const auto pairs =
      matchPoses(loadSequenceTruth(sequence).trajectory, loadTrajectory(run + "/trajectory.txt"));
  const SurfaceSamples surfels = centresOf(loadMap(run + "/map.ply"), alignPoses(pairs));
  const RemainsScore score = checkRemains(surfels.positions, trueSurface(sequence), things);
  std::optional<ThingMaskScore> masks;
  if (std::filesystem::is_directory(run + "/mask")) masks = checkThingMasks(sequence, run);
  if (json) {
    std::cout << toJson(score, masks).dump(2) << "\n";
  } else {
    print(score, masks);
  }
}

}  // namespace pf

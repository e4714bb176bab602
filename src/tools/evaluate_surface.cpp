// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/evaluation/surface_check.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/sequence_facts.hpp"
#include "true_surface.hpp"

namespace pf {
void evaluateSurface(const std::string& run, const std::string& sequence, bool json) {
  const SurfelArrays surfels = loadMap(run + "/map.ply");
  const auto pairs =
      matchPoses(loadSequenceTruth(sequence).trajectory, loadTrajectory(run + "/trajectory.txt"));
  const SurfaceScore score = checkSurface(surfels, alignPoses(pairs), trueSurface(sequence));
  if (json) {
    const nlohmann::ordered_json out = {{"surfels", score.surfels},
                                        {"median_m", score.median_m},
                                        {"p95_m", score.p95_m},
                                        {"in_two_layers", score.in_two_layers},
                                        {"two_layers", score.layerShare()}};
    std::cout << out.dump(2) << "\n";
    return;
  }
  std::printf("stable surfels           %zu\n", score.surfels);
  std::printf("to the true surface      %.1f mm median, %.1f mm 95 %% (all poses aligned)\n",
              1e3 * score.median_m, 1e3 * score.p95_m);
  std::printf(
      "in two layers            %.2f %% (another 2 to 15 cm off where there is one surface)\n",
      100 * score.layerShare());
}

}  // namespace pf

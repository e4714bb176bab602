// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/grid_check.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/grid/floor.hpp"
#include "posefusion/io/grid_file.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/sequence_facts.hpp"
#include "true_surface.hpp"

namespace pf {

void evaluateGrid(const SurfaceQuestion& question) {
  const OccupancyGrid grid = loadGrid(question.surface);
  const Eigen::Isometry3d T_floor_map = floorFrame(loadMap(question.run + "/map.ply"));
  const auto pairs = matchPoses(loadSequenceTruth(question.sequence).trajectory,
                                loadTrajectory(question.run + "/trajectory.txt"));
  const Eigen::Isometry3d T_truth_floor = alignPoses(pairs) * T_floor_map.inverse();
  const GridScore score =
      checkGrid(grid, GridConfig(), T_truth_floor, trueSurface(question.sequence).positions);
  if (question.json) {
    const nlohmann::ordered_json out = {{"seen", score.seen},
                                        {"share", score.share()},
                                        {"false_free", score.false_free},
                                        {"false_occupied", score.false_occupied},
                                        {"near", score.near}};
    std::cout << out.dump(2) << "\n";
    return;
  }
  std::printf("cells seen               %zu\n", score.seen);
  std::printf("right                    %.2f %%\n", 100 * score.share());
  std::printf("free and should not be   %zu\n", score.false_free);
  std::printf("occupied, should not be  %zu\n", score.false_occupied);
  std::printf("of both, one cell off    %zu\n", score.near);
}

}  // namespace pf

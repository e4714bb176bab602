// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/loop_check.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/map_database.hpp"
#include "posefusion/run/sequence_facts.hpp"

namespace pf {

void evaluateLoops(const std::string& map, const std::string& truth, bool json) {
  const MapContent content = MapReader(map).content();
  const auto loops =
      checkLoops(loadSequenceTruth(truth).trajectory, content.keyframes, content.constraints);
  std::vector<double> shifts_m, turns_deg;
  for (const LoopError& loop : loops) {
    shifts_m.push_back(loop.shift_m);
    turns_deg.push_back(loop.turn_deg);
  }
  const ErrorStatistics shift = statisticsOf(shifts_m), turn = statisticsOf(turns_deg);
  const auto wrong =
      std::count_if(loops.begin(), loops.end(), [](const auto& loop) { return loop.isWrong(); });
  if (json) {
    const nlohmann::ordered_json out = {{"loops", loops.size()},     {"wrong", wrong},
                                        {"median_m", shift.median},  {"worst_m", shift.max},
                                        {"median_deg", turn.median}, {"worst_deg", turn.max}};
    std::cout << out.dump(2) << "\n";
    return;
  }
  std::printf("loops with true poses    %zu\n", loops.size());
  std::printf("wrong                    %td (off by more than %.2f m or %.0f deg)\n", wrong,
              kWrongLoop_m, kWrongLoop_deg);
  std::printf("error                    %.4f m median, %.4f m worst; %.3f, %.3f deg\n",
              shift.median, shift.max, turn.median, turn.max);
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/loop_check.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/evaluation/nees.hpp"
#include "posefusion/io/map_database.hpp"
#include "posefusion/run/sequence_facts.hpp"

namespace pf {
namespace {

/// Constraints by what made them.
struct Constraints {
  const char* name;
  std::vector<PoseConstraint> all;
};

/// A keyframe follows the one before; that of a camera that came back hangs on the one nearest to
/// it.
std::vector<Constraints> byOrigin(const std::vector<PoseConstraint>& constraints) {
  std::vector<Constraints> kinds = {
      {"steps", {}}, {"returns", {}}, {"loops", {}}, {"reckoned", {}}};
  for (const PoseConstraint& c : constraints) {
    const auto kind = [&]() -> std::size_t {
      if (c.kind == ConstraintKind::reckoned) return 3;
      if (c.kind == ConstraintKind::loop) return 2;
      return c.to == c.from + 1 ? 0 : 1;
    };
    kinds[kind()].all.push_back(c);
  }
  return kinds;
}

void printConstraintNees(const char* name, const NeesShare& nees) {
  if (nees.windows == 0) return;
  std::printf("NEES of %-16s %.1f %% of %zu within %.2f..%.2f; %.1f %% below, %.1f %% above; ",
              name, 100 * nees.inside, nees.windows, nees.low, nees.high, 100 * nees.too_low,
              100 * nees.too_high);
  std::printf("%.2f median, %.2f mean (5.35, 6 expected)\n", nees.median, nees.mean);
  std::printf("  |error| by its sigma's");
  for (const double axis : nees.axes) std::printf(" %.2f", axis);
  std::printf("  (1 expected)\n");
}

}  // namespace

void evaluateLoops(const std::string& map, const std::string& truth, bool json) {
  const MapContent content = MapReader(map).content();
  const Trajectory poses = loadSequenceTruth(truth).trajectory;
  const auto loops = checkLoops(poses, content.keyframes, content.constraints);
  std::vector<double> shifts_m, turns_deg;
  for (const LoopError& loop : loops) {
    shifts_m.push_back(loop.shift_m);
    turns_deg.push_back(loop.turn_deg);
  }
  const ErrorStatistics shift = statisticsOf(shifts_m), turn = statisticsOf(turns_deg);
  const auto wrong =
      std::count_if(loops.begin(), loops.end(), [](const auto& loop) { return loop.isWrong(); });
  if (json) {
    nlohmann::ordered_json out = {{"loops", loops.size()},     {"wrong", wrong},
                                  {"median_m", shift.median},  {"worst_m", shift.max},
                                  {"median_deg", turn.median}, {"worst_deg", turn.max}};
    for (const Constraints& kind : byOrigin(content.constraints)) {
      const NeesShare nees = neesOfConstraints(poses, content.keyframes, kind.all);
      out["nees"][kind.name] = {{"count", nees.windows},   {"inside", nees.inside},
                                {"too_low", nees.too_low}, {"too_high", nees.too_high},
                                {"median", nees.median},   {"mean", nees.mean},
                                {"axes", nees.axes}};
    }
    std::cout << out.dump(2) << "\n";
    return;
  }
  std::printf("loops with true poses    %zu\n", loops.size());
  std::printf("wrong                    %td (off by more than %.2f m or %.0f deg)\n", wrong,
              kWrongLoop_m, kWrongLoop_deg);
  std::printf("error                    %.4f m median, %.4f m worst; %.3f, %.3f deg\n",
              shift.median, shift.max, turn.median, turn.max);
  for (const Constraints& kind : byOrigin(content.constraints)) {
    printConstraintNees(kind.name, neesOfConstraints(poses, content.keyframes, kind.all));
  }
}

}  // namespace pf

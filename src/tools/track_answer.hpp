// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/evaluation/track_check.hpp"

namespace pf {

/// How one trajectory differs from the truth.
struct TrackErrors {
  Alignment alignment;  ///< the best fit
  ErrorStatistics absolute_m;
  RelativeError per_frame, per_second;
  std::vector<std::size_t> wrong;
  PlaceErrors places;
  double last_m = 0;  ///< of the last pose, in the best fit
};

/// Throws InputError for fewer than three poses with a true one.
TrackErrors trackErrors(const Trajectory& truth, const Trajectory& estimate, bool with_scale);

/// What posefusion_evaluate reports of a run or a trajectory.
struct TrackAnswer {
  TrackErrors errors;               ///< of the trajectory itself: of a run, as corrected by loops
  std::optional<TrackErrors> live;  ///< of a run: as reported at the time
  std::optional<PoseCoverage> coverage;  ///< where the frames of the sequence are known
  std::optional<ErrorStatistics> held_m;
  std::optional<std::size_t> gated;  ///< frames that the run's blur gate dropped
};

/// Print on stdout.
void printTrackJson(const TrackAnswer& answer);
void printTrackTable(const TrackAnswer& answer, bool with_scale);

}  // namespace pf

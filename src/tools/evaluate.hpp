// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pf {

/// posefusion_evaluate TRUTH ESTIMATE
struct TrajectoryQuestion {
  std::string truth;     ///< sequence (TUM folder) or trajectory
  std::string estimate;  ///< trajectory, or output folder of posefusion_run
  std::string plot;      ///< picture to write, empty: none
  std::string plan;      ///< picture to write, empty: none
  bool scene = false;    ///< plan: the simulated room, not the run's map
  bool with_scale = false;
  bool json = false;
};

/// posefusion_evaluate trajectory TRUTH ESTIMATE
struct ComparisonQuestion {
  std::string truth, estimate;
  std::string truth_format = "auto", estimate_format = "auto";
  std::string align = "rigid";
  double max_difference_s = 0.02;
  double offset_s = 0;  ///< added to the stamps of the estimate
  double step = 1;
  std::string step_unit = "frames";
  bool overlapping = false;
  bool json = false;
};

/// posefusion_evaluate run RUN_DIR INPUT
struct RunQuestion {
  std::string run, input;
  std::string truth;   ///< empty: that of the input
  std::string camera;  ///< empty: that of the input
  std::string masks;   ///< empty: INPUT/mask
  std::size_t first_frame = 50, last_frame = 300;
  bool json = false;
};

/// posefusion_evaluate known RUN_DIR SEQUENCE --status FILE
struct KnownQuestion {
  std::string run, sequence, status;
  bool json = false;
};

/// posefusion_evaluate mesh MESH RUN_DIR SEQUENCE
/// posefusion_evaluate grid GRID RUN_DIR SEQUENCE
struct SurfaceQuestion {
  std::string surface;  ///< mesh or grid
  std::string run, sequence;
  bool json = false;
};

/// Each prints its answer on stdout. They throw InputError.
void evaluateTrajectory(const TrajectoryQuestion& question);
void evaluateComparison(const ComparisonQuestion& question);
void evaluateRun(const RunQuestion& question);
void evaluateKnown(const KnownQuestion& question);
void evaluateMesh(const SurfaceQuestion& question);
void evaluateGrid(const SurfaceQuestion& question);
/// posefusion_evaluate masks TRUTH_DIR MASK_DIR
void evaluateMasks(const std::string& truth, const std::string& masks, bool json);
/// posefusion_evaluate covariance TRUTH STATUS_FILE
void evaluateCovariance(const std::string& truth, const std::string& status, bool json);
/// posefusion_evaluate surface RUN_DIR SEQUENCE
void evaluateSurface(const std::string& run, const std::string& sequence, bool json);
/// posefusion_evaluate things RUN_DIR SEQUENCE
void evaluateThings(const std::string& run, const std::string& sequence, bool json);
/// posefusion_evaluate loops MAP_FILE TRUTH
void evaluateLoops(const std::string& map, const std::string& truth, bool json);

}  // namespace pf

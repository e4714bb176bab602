// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/evaluation/map_check.hpp"
#include "posefusion/io/moving_objects_file.hpp"
#include "posefusion/io/status_file.hpp"
#include "posefusion/run/run_report.hpp"
#include "posefusion/slam/pipeline.hpp"
#include "run_options.hpp"

namespace pf {

/// Writes mask/ (a PNG per frame, named by its stamp, 255 = a person or a moving object),
/// people.json, the people as the detector found them, and moving_objects.json.
class MaskWriter {
 public:
  explicit MaskWriter(const std::string& folder);

  void add(const ProcessedFrame& frame);
  void finish();

 private:
  std::string folder_;
  std::vector<People> people_;
  MovingObjectsFile objects_;
};

/// Keeps what became of each frame, for --save-status.
class StatusWriter {
 public:
  explicit StatusWriter(std::string path) : path_(std::move(path)) {}

  void add(const ProcessedFrame& frame);
  void finish() const { saveStatus(path_, rows_); }

 private:
  std::string path_;
  std::vector<StatusRow> rows_;
};

/// Compares the depth of the fused frames, from the fiftieth on, with the map as it is just then.
class LiveDepthCheck {
 public:
  explicit LiveDepthCheck(const SurfelMap& map) : check_(map) {}

  void add(const ProcessedFrame& frame);
  const DepthCheck& check() const { return check_; }

 private:
  DepthCheck check_;
  int index_ = 0;
};

/// Those of the above that the user asked for.
class RunObservers {
 public:
  /// `folder`: of the run. The map must outlive it.
  RunObservers(const RunOptions& options, const std::string& folder, const SurfelMap& map);

  void add(const ProcessedFrame& frame);
  /// Writes the files and adds what was found to the report.
  void finish(RunReport& report);

 private:
  std::optional<MaskWriter> masks_;
  std::optional<StatusWriter> status_;
  std::optional<LiveDepthCheck> depth_;
};

}  // namespace pf

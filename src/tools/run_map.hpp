// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/slam/pipeline.hpp"
#include "run_options.hpp"

namespace pf {

/// Loads the map file of the options. Throws InputError naming it when it cannot be used, or is of
/// another camera than the input.
void loadMap(const RunOptions& options, Pipeline& pipeline);

/// Corrects depth by the calibration file of the options. Throws InputError naming it when it
/// cannot be used, or is of another camera than the input.
void useCalibration(const RunOptions& options, Pipeline& pipeline);

/// The map file that a run writes: `map.pfdb` in its folder (while it lasts, `map.partial.pfdb`),
/// or the one it continues; none where it only localises.
class RunMap {
 public:
  /// `folder`: of the run. Throws InputError naming the file.
  RunMap(const RunOptions& options, const std::string& folder, const Mapper& mapper);

  /// After each frame. Returns what could not be written.
  std::string add(const ProcessedFrame& frame);

  /// Throws InputError naming the file.
  void finish();

 private:
  const Mapper& mapper_;
  std::string path_;
  std::string final_path_;  ///< empty: the same
  std::optional<MapRecording> recording_;
};

}  // namespace pf

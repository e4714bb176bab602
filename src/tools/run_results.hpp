// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "posefusion/io/disk_reserve.hpp"
#include "posefusion/io/run_folder.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/run_report.hpp"
#include "posefusion/slam/pipeline.hpp"
#include "run_map.hpp"
#include "run_observers.hpp"
#include "run_options.hpp"

namespace pf {

/// The files of a run, in a folder of its own below `--output`. While it lasts, and where it was
/// killed or could not be written to its end, the folder is called `.partial`.
class RunResults {
 public:
  /// `pipeline` must outlive it. Throws InputError naming what cannot be written.
  RunResults(const RunOptions& options, const Pipeline& pipeline);

  /// After each frame. The first time that something cannot be written, what; otherwise empty.
  std::string add(const ProcessedFrame& frame);

  /// Writes all. What cannot be written keeps nothing else from being. Throws InputError naming
  /// what is missing then; otherwise `latest` leads here, if any frame has a pose.
  void finish(RunReport& report);

  std::string path() const { return folder_.path(); }

 private:
  /// False where `write` throws, which is kept for the end.
  bool attempt(const std::function<void()>& write);
  void finishSurfaces();
  std::string disturbance(const ProcessedFrame& frame);

  const Pipeline& pipeline_;
  std::string mesh_file_;
  std::string view_title_;  // empty: no page
  RunFolder folder_;
  DiskReserve reserve_;
  TrajectoryJournal journal_;
  RunMap map_;
  RunObservers observers_;
  bool is_disturbed_ = false;
  std::vector<std::string> failed_;
};

}  // namespace pf

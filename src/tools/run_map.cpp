// SPDX-License-Identifier: BSD-3-Clause
#include "run_map.hpp"

#include <filesystem>

#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"

namespace pf {
namespace {

constexpr char kPartial[] = "/map.partial.pfdb", kWhole[] = "/map.pfdb";

}  // namespace

void loadMap(const RunOptions& options, Pipeline& pipeline) {
  SavedMap map = readSavedMap(options.map_file);
  const auto source = posefusion_ros::openInput(options.input, options.reading);
  const std::string defect = cameraDefect(options.map_file, map.camera, *source, options.input);
  if (!defect.empty()) throw InputError(defect);
  try {
    pipeline.load(std::move(map), options.localize_only ? MapUse::localize_only : MapUse::extend);
  } catch (const InputError& error) {
    throw InputError(options.map_file + ": " + error.what());
  }
}

void useCalibration(const RunOptions& options, Pipeline& pipeline) {
  const DepthCalibration calibration = loadCalibration(options.calibration);
  const auto source = posefusion_ros::openInput(options.input, options.reading);
  const auto camera = firstCamera(*source);
  const std::string wrong = camera ? misfit(calibration, *camera) : "";
  if (!wrong.empty()) throw InputError(options.calibration + ": " + wrong);
  pipeline.calibrate(calibration);
}

RunMap::RunMap(const RunOptions& options, const std::string& folder, const Mapper& mapper)
    : mapper_(mapper) {
  if (options.localize_only) return;
  const std::string settings = toYaml(options.config);
  if (options.continue_map) {
    path_ = options.map_file;
    recording_.emplace(path_, MapWriter::Mode::extend, settings, mapper);
    return;
  }
  path_ = folder + kPartial;
  final_path_ = folder + kWhole;
  recording_.emplace(path_, MapWriter::Mode::create, settings, mapper);
}

std::string RunMap::add(const ProcessedFrame& frame) {
  // In a fragment frames are fused, and no pose is known.
  const bool fused = frame.status.outcome == FrameOutcome::fused;
  if (!recording_ || (!frame.status.located && !fused)) return {};
  return recording_->update(frame.seen.frame.camera, mapper_);
}

void RunMap::finish() {
  if (!recording_) return;
  const bool any = recording_->finish(mapper_);
  recording_.reset();
  if (final_path_.empty()) return;
  if (any) return renameMapFile(path_, final_path_);
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace pf

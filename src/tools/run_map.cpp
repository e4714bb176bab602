// SPDX-License-Identifier: BSD-3-Clause
#include "run_map.hpp"

#include <filesystem>
#include <sstream>

#include "posefusion/core/error.hpp"
#include "posefusion/frame/working_frame.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

constexpr char kPartial[] = "/map.partial.pfdb", kWhole[] = "/map.pfdb";
constexpr char kLog[] = "-wal";  // SQLite's companion file

std::string textOf(const PinholeCamera& c) {
  std::ostringstream out;
  out << c.width << " x " << c.height << ", fx " << c.fx << " fy " << c.fy << " cx " << c.cx
      << " cy " << c.cy;
  return out.str();
}

/// The camera of the input's frames, rectified as the chain does; nothing when no frame is good.
std::optional<PinholeCamera> cameraOf(const RunOptions& options) {
  const auto source = posefusion_ros::openInput(options.input, options.reading);
  while (const auto next = source->next()) {
    if (next->defect.empty() && defectOf(next->frame).empty()) {
      return Rectifier().rectify(next->frame).camera;
    }
  }
  return std::nullopt;
}

/// What a killed run left is kept as `.old`.
void setAside(const std::string& path) {
  std::error_code ignored;
  fs::rename(path, path + ".old", ignored);
  fs::remove(path + ".old" + kLog, ignored);
  fs::rename(path + kLog, path + ".old" + kLog, ignored);
}

}  // namespace

void loadMap(const RunOptions& options, Pipeline& pipeline) {
  SavedMap map = readSavedMap(options.map_file);
  const auto camera = cameraOf(options);
  if (camera && *camera != map.camera) {
    throw InputError(options.map_file + ": is a map of another camera (" + textOf(map.camera) +
                     ") than " + options.input + " (" + textOf(*camera) + ")");
  }
  try {
    pipeline.load(std::move(map), options.localize_only ? MapUse::localize_only : MapUse::extend);
  } catch (const InputError& error) {
    throw InputError(options.map_file + ": " + error.what());
  }
}

RunMap::RunMap(const RunOptions& options, const Mapper& mapper) : mapper_(mapper) {
  if (options.localize_only) return;
  const std::string settings = toYaml(options.config);
  if (options.continue_map) {
    path_ = options.map_file;
    recording_.emplace(path_, MapWriter::Mode::extend, settings, mapper);
    return;
  }
  path_ = options.output + kPartial;
  final_path_ = options.output + kWhole;
  setAside(path_);
  recording_.emplace(path_, MapWriter::Mode::create, settings, mapper);
}

std::string RunMap::add(const ProcessedFrame& frame) {
  if (!recording_ || !frame.status.located) return {};
  return recording_->update(frame.seen.frame.camera, mapper_);
}

void RunMap::finish() {
  if (!recording_) return;
  const bool any = recording_->finish(mapper_);
  recording_.reset();
  if (final_path_.empty()) return;
  std::error_code error;
  if (!any) {
    fs::remove(path_, error);
    return;
  }
  if (!fs::exists(path_ + kLog)) fs::rename(path_, final_path_, error);
  if (error) throw InputError(final_path_ + ": cannot be written: " + error.message());
}

}  // namespace pf

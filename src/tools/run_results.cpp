// SPDX-License-Identifier: BSD-3-Clause
#include "run_results.hpp"

#include <filesystem>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/map_page.hpp"
#include "posefusion/io/mesh_file.hpp"
#include "posefusion/map/stable_surfels.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"

namespace pf {
namespace {

constexpr char kJournal[] = "trajectory.partial.txt";
// Trajectories and summary of an hour at 30 Hz, 130 bytes a pose each.
constexpr std::int64_t kReserve_bytes = 32'000'000;

/// Of a recording, for people.
std::string nameOf(const std::string& input) {
  const auto path = std::filesystem::absolute(input).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

RunResults::RunResults(const RunOptions& options, const Pipeline& pipeline)
    : pipeline_(pipeline),
      mesh_file_(options.mesh_file),
      view_title_(options.view ? nameOf(options.input) : ""),
      folder_(options.output, RunFolder::Name::partial),
      reserve_(folder_.file("reserve"), kReserve_bytes),
      journal_(folder_.file(kJournal), "the run is not finished"),
      map_(options, folder_.path(), pipeline.mapper()),
      observers_(options, folder_.path(), pipeline.mapper().map()) {}

std::string RunResults::add(const ProcessedFrame& frame) {
  observers_.add(frame);
  const std::string trouble = disturbance(frame);
  if (trouble.empty() || std::exchange(is_disturbed_, true)) return {};
  return trouble + "; the run goes on and tries again";
}

std::string RunResults::disturbance(const ProcessedFrame& frame) {
  std::string text = map_.add(frame);
  const FrameStatus& status = frame.status;
  if (status.located &&
      !journal_.add({status.stamp_ns, pipeline_.mapper().worldFromMap() * status.T_map_camera}) &&
      text.empty()) {
    text = folder_.file(kJournal) + " cannot be written (disk full?)";
  }
  return text;
}

bool RunResults::attempt(const std::function<void()>& write) {
  try {
    write();
    return true;
  } catch (const std::exception& error) {
    failed_.emplace_back(error.what());
    return false;
  }
}

void RunResults::finishSurfaces() {
  if (mesh_file_.empty() && view_title_.empty()) return;
  const Mapper& mapper = pipeline_.mapper();
  const SurfelArrays surfels = stableSurfels(mapper.map(), mapper.worldFromMap());
  if (!mesh_file_.empty()) attempt([&] { saveMesh(mesh_file_, surfelMesh(surfels, {})); });
  if (view_title_.empty()) return;
  attempt([&] { saveMapPage(folder_.file("view.html"), surfels, view_title_, {}); });
}

void RunResults::finish(RunReport& report) {
  const Mapper& mapper = pipeline_.mapper();
  reserve_.release();
  // What is small and cannot be had again comes first.
  const bool has_poses =
      attempt([&] { report.writeTrajectories(folder_.path(), mapper.worldFromMap()); });
  if (has_poses) journal_.remove();
  attempt([&] { observers_.finish(report); });
  if (mapper.calibration()) {
    attempt([&] { saveCalibration(folder_.file("calibration.yaml"), *mapper.calibration()); });
  }
  attempt([&] { report.writeSummary(folder_.path(), savedSurfels(mapper.map())); });
  attempt([&] { map_.finish(); });
  attempt([&] { saveMap(folder_.file("map.ply"), mapper.map(), mapper.worldFromMap()); });
  attempt([&] { finishSurfaces(); });
  attempt([&] { report.writePictures(folder_.path(), mapper.map()); });
  if (failed_.empty()) {
    folder_.finish();
    if (!report.trajectory().empty()) folder_.makeLatest();
    return;
  }
  std::string text = "not all of the results could be written; the others are in " + path();
  for (const std::string& failure : failed_) text += "\n  " + failure;
  throw InputError(text);
}

}  // namespace pf

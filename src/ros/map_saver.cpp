// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/map_saver.hpp"

#include <filesystem>
#include <system_error>

#include "posefusion/core/error.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/mesh_file.hpp"

namespace posefusion_ros {
namespace {

constexpr char kPose[] =
    "pose of the camera (optical frame: z forward, x right, y down) in the map";
constexpr char kDefaultOutput[] = "posefusion_output";
constexpr char kMap[] = "map.ply", kDatabase[] = "map.pfdb";
constexpr char kTrajectory[] = "trajectory.txt";
constexpr char kPartial[] = "trajectory.partial.txt", kPartialDatabase[] = "map.partial.pfdb";
constexpr char kNewDatabase[] = "map.pfdb.part";
constexpr char kMesh[] = "mesh.ply", kMeshOnRequest[] = "_mesh";
constexpr char kOnRequest[] = "_saved";  // what a folder's name ends with that was asked for

namespace fs = std::filesystem;

pf::Trajectory posesOf(const MapToSave& map) {
  pf::Trajectory trajectory = map.trajectory();
  if (trajectory.empty()) throw pf::InputError("nothing to save: no frame was fused");
  return trajectory;
}

/// Returns how much there is.
std::string write(const MapToSave& map, const pf::Trajectory& trajectory,
                  const std::string& map_file, const std::string& trajectory_file) {
  const Eigen::Isometry3d T_world_map = map.mapper.worldFromMap();
  pf::saveTrajectory(trajectory_file, pf::inWorld(T_world_map, trajectory), kPose);
  const std::size_t surfels = pf::saveMap(map_file, map.mapper.map(), T_world_map);
  return std::to_string(surfels) + " surfels, " + std::to_string(trajectory.size()) + " poses";
}

}  // namespace

MapSaverSettings readMapSaver(Parameters& parameters) {
  MapSaverSettings s;
  s.output = parameters.text("output", s.output);
  s.period_s = parameters.number("save_period_s", s.period_s, {0.0, 86400.0});
  s.maps_kept = parameters.integer("maps_kept", s.maps_kept, {0, 1000000});
  return s;
}

MapSaver::MapSaver(const MapSaverSettings& settings) : settings_(settings) {
  if (isOn()) folder();
}

MapSaver::~MapSaver() {
  endSaveOnTheWay();
  if (folder_) folder_->removeIfEmpty();
}

std::string MapSaver::output() const { return isOn() ? settings_.output : kDefaultOutput; }

const pf::RunFolder& MapSaver::folder() {
  if (!folder_) folder_.emplace(output());
  return *folder_;
}

std::string MapSaver::resolve(const std::string& path) const {
  return fs::absolute(fs::path(output()) / path).lexically_normal().string();
}

void MapSaver::continueIn(const std::string& file, const MapToSave& map) {
  recording_.emplace(file, pf::MapWriter::Mode::extend, settings_.settings, map.mapper);
  continued_ = file;
}

std::string MapSaver::save(const MapToSave& map) {
  const pf::Trajectory trajectory = posesOf(map);
  const std::string continued = saveContinued(map);
  pf::RunFolder target(output(), pf::RunFolder::Name::partial, kOnRequest);
  std::string counts;
  try {
    counts = write(map, trajectory, target.file(kMap), target.file(kTrajectory));
    writeDatabase(map, target.file(kDatabase));
    target.finish();
  } catch (const std::exception&) {
    target.discard();
    throw;
  }
  target.makeLatest();
  return "saved map.ply, map.pfdb and trajectory.txt (" + counts + ") in " + target.path() +
         (continued.empty() ? "" : "; " + continued);
}

std::string MapSaver::saveMesh(const pf::TriangleMesh& mesh) const {
  pf::RunFolder target(output(), pf::RunFolder::Name::partial, kMeshOnRequest);
  try {
    pf::saveMesh(target.file(kMesh), mesh);
    target.finish();
  } catch (const std::exception&) {
    target.discard();
    throw;
  }
  return "saved mesh.ply (" + std::to_string(mesh.triangles.size()) + " triangles) in " +
         target.path();
}

/// Into the folder of the map that grows.
std::string MapSaver::saveHere(const MapToSave& map) {
  const pf::Trajectory trajectory = posesOf(map);
  endSaveOnTheWay();
  const pf::RunFolder& target = folder();
  const std::string counts = write(map, trajectory, target.file(kMap), target.file(kTrajectory));
  const std::string continued = saveContinued(map);
  if (continued.empty() && recording_) saveDatabase(map);
  target.makeLatest();
  saved_ = Clock::now();
  return "saved map.ply and trajectory.txt (" + counts + ") in " + target.path() +
         (continued.empty() ? "" : "; " + continued);
}

/// Updates the file that the session continues; returns a sentence that says so.
std::string MapSaver::saveContinued(const MapToSave& map) {
  if (continued_.empty()) return {};
  recording_->update(map.camera, map.mapper);
  recording_->finish(map.mapper);
  return "the map goes on in " + continued_;
}

void MapSaver::writeDatabase(const MapToSave& map, const std::string& file) const {
  pf::MapRecording whole(file, pf::MapWriter::Mode::create, settings_.settings, map.mapper);
  whole.update(map.camera, map.mapper);
  whole.finish(map.mapper);
}

/// The map as it is, beside the one that is being recorded.
void MapSaver::saveDatabase(const MapToSave& map) {
  const std::string fresh = folder().file(kNewDatabase);
  std::error_code ignored;
  fs::remove(fresh, ignored);
  writeDatabase(map, fresh);
  pf::renameMapFile(fresh, folder().file(kDatabase), pf::IfThere::replace);
}

/// What is partial is not needed any more.
void MapSaver::endRecording() {
  if (journal_) journal_->remove();
  journal_.reset();
  const bool was_recorded = recording_ && continued_.empty();
  recording_.reset();
  if (!was_recorded) return;
  std::error_code ignored;
  fs::remove(folder().file(kPartialDatabase), ignored);
}

std::string MapSaver::saveInBetween(const MapToSave& map) {
  if (map.trajectory().empty()) return {};
  return isOn() ? saveHere(map) : saveContinued(map);
}

std::string MapSaver::finish(const MapToSave& map) {
  try {
    const std::string said = isOn() ? saveHere(map) : saveContinued(map);
    endRecording();
    return said;
  } catch (const std::exception& error) {
    return error.what();
  }
}

std::string MapSaver::beginAnew(const MapToSave& map, const std::string& next) {
  const std::string said = saveInBetween(map);
  if (!said.empty() && isOn()) {
    endRecording();
    ended_.add(*folder_, {kMap, kDatabase, kTrajectory});
  }
  // Of a map without a pose, what was recorded stays as it is.
  if (!said.empty() || recording_) abandon();
  if (settings_.maps_kept > 0) ended_.keep(static_cast<std::size_t>(settings_.maps_kept), next);
  return said;
}

void MapSaver::abandon() {
  endSaveOnTheWay();
  journal_.reset();
  recording_.reset();
  continued_.clear();
  folder_.reset();
}

std::string MapSaver::note(const pf::FrameStatus& status, const MapToSave& map, bool may_change) {
  // In a fragment frames are fused, and no pose is known.
  const bool fused = status.outcome == pf::FrameOutcome::fused;
  if ((!isOn() && continued_.empty()) || (!status.located && !fused)) return {};
  std::string trouble;
  try {
    trouble = record(map, fused && may_change);
    if (!isOn()) return trouble;
    if (status.located && !journal_) {
      journal_ = std::make_unique<pf::TrajectoryJournal>(folder().file(kPartial), kPose);
    }
  } catch (const std::exception& error) {
    return error.what();
  }
  if (status.located &&
      !journal_->add({status.stamp_ns, map.mapper.worldFromMap() * status.T_map_camera}))
    return folder().file(kPartial) + ": cannot be written (disk full?)";
  const auto period = std::chrono::duration<double>(settings_.period_s);
  if (settings_.period_s > 0 && Clock::now() - saved_ >= period) {
    const std::string failed = endSaveOnTheWay();
    saveOnTheWay(map.mapper);
    if (!failed.empty()) return failed;
  }
  return trouble.empty() ? folder().lowSpace() : trouble;
}

/// The map file grows from the first frame that was fused on.
std::string MapSaver::record(const MapToSave& map, bool changed) {
  if (!recording_ && changed) {
    recording_.emplace(folder().file(kPartialDatabase), pf::MapWriter::Mode::create,
                       settings_.settings, map.mapper);
  }
  return recording_ ? recording_->update(map.camera, map.mapper) : "";
}

void MapSaver::saveOnTheWay(const pf::Mapper& mapper) {
  saved_ = Clock::now();
  // A copy takes some milliseconds, the disk may take a second.
  saving_ = std::async(std::launch::async,
                       [copy = mapper.map(), target = folder(), T = mapper.worldFromMap()] {
                         try {
                           pf::saveMap(target.file(kMap), copy, T);
                           target.makeLatest();
                           return std::string();
                         } catch (const std::exception& error) {
                           return std::string(error.what());
                         }
                       });
}

std::string MapSaver::endSaveOnTheWay() { return saving_.valid() ? saving_.get() : ""; }

}  // namespace posefusion_ros

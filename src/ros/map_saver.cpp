// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/map_saver.hpp"

#include <filesystem>
#include <system_error>

#include "posefusion/core/error.hpp"
#include "posefusion/io/map_file.hpp"

namespace posefusion_ros {
namespace {

constexpr char kPose[] =
    "pose of the camera (optical frame: z forward, x right, y down) in the map";
constexpr char kDefaultOutput[] = "posefusion_output";
constexpr char kMap[] = "map.ply";
constexpr char kTrajectory[] = "trajectory.txt";
constexpr char kPartial[] = "trajectory.partial.txt";

/// Removes what save() wrote, and the folder where nothing else is in it.
void forget(const pf::RunFolder& old) {
  std::error_code ignored;
  for (const char* name : {kMap, kTrajectory}) std::filesystem::remove(old.file(name), ignored);
  old.removeIfEmpty();
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

const pf::RunFolder& MapSaver::folder() {
  if (!folder_) folder_.emplace(isOn() ? settings_.output : kDefaultOutput);
  return *folder_;
}

std::string MapSaver::save(const pf::SurfelMap& map, const pf::Trajectory& trajectory) {
  if (trajectory.empty()) throw pf::InputError("nothing to save: no frame was fused");
  endSaveOnTheWay();
  const pf::RunFolder& target = folder();
  pf::saveTrajectory(target.file(kTrajectory), pf::inWorld(T_map_start_, trajectory), kPose);
  const std::size_t surfels = pf::saveMap(target.file(kMap), map, T_map_start_);
  target.makeLatest();
  saved_ = Clock::now();
  return "saved map.ply (" + std::to_string(surfels) + " surfels) and trajectory.txt (" +
         std::to_string(trajectory.size()) + " poses) in " + target.path();
}

std::string MapSaver::finish(const pf::SurfelMap& map, const pf::Trajectory& trajectory) {
  try {
    const std::string said = save(map, trajectory);
    if (journal_) journal_->remove();
    journal_.reset();
    return said;
  } catch (const std::exception& error) {
    return error.what();
  }
}

std::string MapSaver::beginAnew(const pf::SurfelMap& map, const pf::Trajectory& trajectory) {
  if (trajectory.empty()) return {};
  std::string said;
  if (isOn()) {
    said = save(map, trajectory);
    if (journal_) journal_->remove();
    ended_.push_back(*folder_);
    if (settings_.maps_kept > 0 && ended_.size() > static_cast<std::size_t>(settings_.maps_kept)) {
      forget(ended_.front());
      ended_.pop_front();
    }
  }
  abandon();
  return said;
}

void MapSaver::abandon() {
  T_map_start_ = pf::bodyFromOptical();
  endSaveOnTheWay();
  journal_.reset();
  folder_.reset();
}

std::string MapSaver::note(const pf::StampedPose& pose, const pf::SurfelMap& map) {
  if (!isOn()) return {};
  try {
    if (!journal_) {
      journal_ = std::make_unique<pf::TrajectoryJournal>(folder().file(kPartial), kPose);
    }
  } catch (const std::exception& error) {
    return error.what();
  }
  if (!journal_->add({pose.stamp_ns, T_map_start_ * pose.T_world_camera}))
    return folder().file(kPartial) + ": cannot be written (disk full?)";
  const auto period = std::chrono::duration<double>(settings_.period_s);
  if (settings_.period_s > 0 && Clock::now() - saved_ >= period) {
    const std::string failed = endSaveOnTheWay();
    saveOnTheWay(map);
    if (!failed.empty()) return failed;
  }
  return folder().lowSpace();
}

void MapSaver::saveOnTheWay(const pf::SurfelMap& map) {
  saved_ = Clock::now();
  // A copy takes some milliseconds, the disk may take a second.
  saving_ = std::async(std::launch::async, [copy = map, target = folder(), T = T_map_start_] {
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

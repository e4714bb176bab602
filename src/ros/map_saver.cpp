// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/map_saver.hpp"

#include <filesystem>
#include <utility>

#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace posefusion_ros {
namespace {

constexpr char kPose[] =
    "pose of the camera (optical frame: z forward, x right, y down) in the map";

std::string saveInto(const std::filesystem::path& folder, const pf::SurfelMap& map,
                     const pf::Trajectory& trajectory) {
  if (trajectory.empty()) return "nothing to save: no frame was fused";
  pf::makeFolder(folder.string());
  pf::saveTrajectory((folder / "trajectory.txt").string(), trajectory, kPose);
  const std::size_t surfels = pf::saveMap((folder / "map.ply").string(), map);
  return "saved map.ply (" + std::to_string(surfels) + " surfels) and trajectory.txt (" +
         std::to_string(trajectory.size()) + " poses) in " +
         std::filesystem::absolute(folder).string();
}

}  // namespace

MapSaver::MapSaver(const std::string& folder)
    : folder_(folder.empty() ? "posefusion_output" : folder), is_on_(!folder.empty()) {}

std::string MapSaver::save(const pf::SurfelMap& map, const pf::Trajectory& trajectory) {
  return saveInto(folder_, map, trajectory);
}

std::string MapSaver::finish(const pf::SurfelMap& map, const pf::Trajectory& trajectory) {
  try {
    const std::string said = save(map, trajectory);
    discard();
    return said;
  } catch (const std::exception& error) {
    return error.what();
  }
}

std::string MapSaver::saveBeforeReset(const pf::SurfelMap& map, const pf::Trajectory& trajectory) {
  const auto journal = std::exchange(journal_, nullptr);
  const std::string said =
      saveInto(std::filesystem::path(folder_) / ("before_reset_" + std::to_string(++resets_)), map,
               trajectory);
  if (journal) journal->remove();
  return said;
}

std::string MapSaver::note(const pf::StampedPose& pose) {
  if (!is_on_) return {};
  const std::string path = (std::filesystem::path(folder_) / "trajectory.partial.txt").string();
  try {
    if (!journal_) {
      pf::makeFolder(folder_);
      journal_ = std::make_unique<pf::TrajectoryJournal>(path, kPose);
    }
  } catch (const std::exception& error) {
    return error.what();
  }
  return journal_->add(pose) ? "" : path + ": cannot be written (disk full?)";
}

void MapSaver::discard() {
  if (journal_) journal_->remove();
  journal_.reset();
}

}  // namespace posefusion_ros

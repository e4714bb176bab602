// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "evaluate.hpp"
#include "posefusion/evaluation/known_world.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/status_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/mask_folders.hpp"
#include "posefusion/run/sequence_facts.hpp"
#include "posefusion_ros/bags/bag_source.hpp"

namespace pf {
namespace {

/// Sharp frames of a recording: those that should be located, and of them those that were.
struct KnownFrames {
  std::size_t sharp = 0, known = 0;
  std::size_t posed = 0;        ///< at the time
  std::size_t posed_since = 0;  ///< in the trajectory at the end
};

std::set<std::int64_t> stampsOf(const std::string& trajectory) {
  std::set<std::int64_t> stamps;
  for (const auto& pose : loadTrajectory(trajectory)) stamps.insert(pose.stamp_ns);
  return stamps;
}

KnownFrames countKnown(const KnownQuestion& question) {
  const auto source = posefusion_ros::openInput(question.sequence, {});
  const std::set<std::int64_t> finally = stampsOf(question.run + "/trajectory.txt");
  std::map<std::int64_t, StatusRow> rows;
  Trajectory asked;
  for (const StatusRow& row : loadStatus(question.status)) {
    rows[row.stamp_ns] = row;
    asked.push_back({row.stamp_ns, row.T_map_camera});
  }
  std::map<std::int64_t, Eigen::Isometry3d> truth;
  for (const PosePair& pair : matchPoses(loadSequenceTruth(question.sequence).trajectory, asked)) {
    truth[pair.estimate.stamp_ns] = pair.truth.T_world_camera;
  }
  KnownFrames counts;
  KnownWorld world;
  while (const auto next = source->next()) {
    const RgbdFrame& frame = next->frame;
    const auto row = rows.find(frame.stamp_ns);
    const auto pose = truth.find(frame.stamp_ns);
    if (!next->defect.empty() || row == rows.end() || pose == truth.end()) continue;
    const cv::Mat mask = loadMask(question.sequence + "/mask", frame.stamp_ns);
    const KnownWorld::View view = world.look(frame, mask, pose->second);
    if (row->second.has_pose) world.learn();
    if (row->second.outcome == "blurred") continue;
    ++counts.sharp;
    if (!view.shouldBeKnown()) continue;
    ++counts.known;
    counts.posed += row->second.has_pose ? 1 : 0;
    counts.posed_since += finally.count(frame.stamp_ns);
  }
  return counts;
}

}  // namespace

void evaluateKnown(const KnownQuestion& question) {
  const KnownFrames counts = countKnown(question);
  const auto share = [&](std::size_t part) {
    return counts.known > 0 ? static_cast<double>(part) / static_cast<double>(counts.known) : 1.0;
  };
  if (question.json) {
    const nlohmann::ordered_json out = {{"sharp", counts.sharp},
                                        {"known", counts.known},
                                        {"share_posed", share(counts.posed)},
                                        {"share_posed_in_the_end", share(counts.posed_since)}};
    std::cout << out.dump(2) << "\n";
    return;
  }
  std::printf("sharp frames             %zu\n", counts.sharp);
  std::printf("see the mapped world     %zu (%.0f %% of a view that is not covered)\n",
              counts.known, 100 * KnownWorld::kKnown);
  std::printf("of them with a pose      %.2f %% at the time, %.2f %% in the end\n",
              100 * share(counts.posed), 100 * share(counts.posed_since));
}

}  // namespace pf

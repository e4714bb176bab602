// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/map_check.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/mask_folders.hpp"
#include "posefusion_ros/bags/bag_source.hpp"

namespace fs = std::filesystem;

namespace pf {
namespace {

using Poses = std::map<std::int64_t, Eigen::Isometry3d>;

/// A map of saved surfels; all that was saved is stable.
SurfelMap mapOf(const SurfelArrays& surfels) {
  MapConfig config;
  config.stable_probability = 0.0;
  config.memory_limit_mb = 1e6;
  SurfelMap map(config);
  map.add(surfels);
  return map;
}

Poses posesOf(const Trajectory& trajectory) {
  Poses poses;
  for (const auto& pose : trajectory) poses[pose.stamp_ns] = pose.T_world_camera;
  return poses;
}

/// True poses, brought into the frame of the map by the alignment of the poses.
Poses truePosesInMap(const Trajectory& truth, const Trajectory& estimate) {
  Poses poses;
  if (truth.empty()) return poses;
  const auto pairs = matchPoses(truth, estimate);
  const Eigen::Isometry3d T_truth_map = alignPoses(pairs);
  for (const auto& pair : pairs) {
    poses[pair.estimate.stamp_ns] = T_truth_map.inverse() * pair.truth.T_world_camera;
  }
  return poses;
}

/// Frame and mask without lens distortion. Takes the mask along as the colour.
class Undistorter {
 public:
  void apply(RgbdFrame& frame, cv::Mat& mask) {
    if (!frame.camera.isDistorted()) return;
    RgbdFrame masked = frame;
    if (!mask.empty()) cv::cvtColor(mask, masked.color, cv::COLOR_GRAY2RGB);
    frame = rectifier_.rectify(masked);
    if (mask.empty()) return;
    cv::extractChannel(frame.color, mask, 0);
    mask = mask > 127;
  }

 private:
  Rectifier rectifier_;
};

void printAnswer(const DepthCheck& depth, const PeopleCheck& people, const ViewCheck& view,
                 std::size_t masked_frames, bool json) {
  if (json) {
    nlohmann::ordered_json out;
    out["depth"] = {{"frames", depth.frames()},
                    {"pixels", depth.pixels()},
                    {"coverage", depth.coverage()},
                    {"median_abs_difference_m", depth.medianM()}};
    out["people_in_map"] = {{"frames_with_masks", masked_frames},
                            {"surfels", people.surfels()},
                            {"on_people", people.onPeople()},
                            {"part", people.part()}};
    out["beside_people"] = {{"least_part_of_view", ViewCheck::kEnough},
                            {"frames", view.frames()},
                            {"with_a_pose", view.posed()}};
    std::cout << out.dump(2) << "\n";
    return;
  }
  std::printf("depth against the map   %.2f mm median over %zu frames (map covers %.1f %%)\n",
              1e3 * depth.medianM(), depth.frames(), 100 * depth.coverage());
  if (masked_frames == 0) {
    std::printf("surfels on people       no true masks and poses\n");
  } else {
    std::printf("surfels on people       %.2f %% (%zu of %zu; %zu frames with true masks)\n",
                100 * people.part(), people.onPeople(), people.surfels(), masked_frames);
    std::printf("poses beside people     %zu of the %zu frames of which people leave %.0f %%\n",
                view.posed(), view.frames(), 100 * ViewCheck::kEnough);
  }
}

}  // namespace

void evaluateRun(const RunQuestion& q) {
  const SurfelArrays surfels = loadMap(q.run + "/map.ply");
  const SurfelMap map = mapOf(surfels);
  const Trajectory estimate = loadTrajectory(q.run + "/trajectory.txt");
  posefusion_ros::InputOptions reading;
  reading.camera_file = q.camera;
  const auto source = posefusion_ros::openInput(q.input, reading);
  const Poses poses = posesOf(estimate);
  const std::string live_file = q.run + "/trajectory_live.txt";
  const Poses live = fs::exists(live_file) ? posesOf(loadTrajectory(live_file)) : poses;
  const Poses true_poses =
      truePosesInMap(q.truth.empty() ? source->truth() : loadTrajectory(q.truth), estimate);
  const std::string masks = q.masks.empty() ? q.input + "/mask" : q.masks;

  DepthCheck depth(map);
  PeopleCheck people(surfels);
  ViewCheck view;
  Undistorter undistorter;
  std::size_t masked_frames = 0;
  for (std::size_t i = 0; auto next = source->next(); ++i) {
    RgbdFrame& frame = next->frame;
    if (!next->defect.empty()) continue;
    cv::Mat mask = loadMask(masks, frame.stamp_ns);
    undistorter.apply(frame, mask);
    if (!mask.empty()) view.add(frame, mask, live.count(frame.stamp_ns) > 0);
    const auto pose = poses.find(frame.stamp_ns);
    if (pose == poses.end()) continue;
    if (i >= q.first_frame && i < q.last_frame) depth.add(frame, mask, pose->second);
    const auto true_pose = true_poses.find(frame.stamp_ns);
    if (mask.empty() || true_pose == true_poses.end()) continue;
    people.add(frame, mask, true_pose->second);
    ++masked_frames;
  }
  printAnswer(depth, people, view, masked_frames, q.json);
}

}  // namespace pf

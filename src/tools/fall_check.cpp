// SPDX-License-Identifier: BSD-3-Clause
// For the bench: how soon a camera came back after each fall of a recording, by what its views
// truly overlap of the map. The map was made before (of another recording of the same room), or by
// the run itself: then only what was mapped before the first fall counts.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/evaluation/fall_check.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/evaluation/view_overlap.hpp"
#include "posefusion/io/events_file.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/io/status_file.hpp"
#include "posefusion/loop/verify.hpp"
#include "posefusion/run/sequence_facts.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kSamePlace_m = 0.10, kSamePlace_rad = 5.0 * kDegree;

struct Options {
  std::string sequence, status, map, map_sequence;
  bool each = false;
};

/// Where the map says that the frames of the first fragment were taken, up to a time.
Trajectory mappedPoses(const SavedMap& map, std::int64_t until_ns) {
  Trajectory poses;
  for (const FrameRecord& frame : map.frames) {
    const Keyframe& keyframe = map.keyframes.at(static_cast<std::size_t>(frame.pose.keyframe));
    if (keyframe.fragment != kFirstFragment || frame.stamp_ns >= until_ns) continue;
    poses.push_back({frame.stamp_ns, poseOf(frame.pose, map.keyframes)});
  }
  return poses;
}

/// The true poses of frames, in the frame of the truth.
std::map<std::int64_t, Eigen::Isometry3d> truthOf(const Trajectory& truth,
                                                  const std::vector<StatusRow>& rows) {
  Trajectory frames;
  for (const StatusRow& row : rows) frames.push_back({row.stamp_ns, row.T_map_camera});
  std::map<std::int64_t, Eigen::Isometry3d> poses;
  for (const PosePair& pair : matchPoses(truth, frames)) {
    poses[pair.estimate.stamp_ns] = pair.truth.T_world_camera;
  }
  return poses;
}

/// Fills in what a frame's true view shows.
class Judge {
 public:
  explicit Judge(const SurfelMap& map) : map_(map), overlap_(map), verifier_(TrackingConfig{}) {}

  FallFrame judge(const StatusRow& row, const RgbdFrame& frame,
                  const Eigen::Isometry3d& T_map_true) {
    FallFrame fall;
    fall.stamp_ns = row.stamp_ns;
    fall.tracking = row.state == "tracking";
    fall.lost = row.state == "lost";
    fall.has_pose = row.has_pose;
    fall.overlap = overlap_.of(frame, T_map_true);
    if (!row.has_pose) return fall;
    fall.setError(T_map_true.inverse() * row.T_map_camera);
    fall.from_truth_m = fall.error_m;
    if (fall.isWrong()) fall.setError(inMap(frame, T_map_true).inverse() * row.T_map_camera);
    return fall;
  }

 private:
  /// Where the map itself has a true view: it is bent by some centimetres. As it is where the two
  /// do not fit.
  Eigen::Isometry3d inMap(const RgbdFrame& frame, const Eigen::Isometry3d& T_map_true) {
    WorkingFrame working;
    working.assign(frame, cv::Mat(), FrameConfig{});
    const PlaceVerdict place = verifier_.verify(map_, working, {kFirstFragment, T_map_true});
    return place.accepted() ? place.alignment.T_map_camera : T_map_true;
  }

  const SurfelMap& map_;
  ViewOverlap overlap_;
  PlaceVerifier verifier_;
};

nlohmann::ordered_json toJson(const FallReturn& fall, std::int64_t start_ns) {
  const auto after = [&](const std::optional<std::int64_t>& stamp_ns) {
    return stamp_ns ? nlohmann::ordered_json(1e-9 * static_cast<double>(*stamp_ns - start_ns))
                    : nlohmann::ordered_json();
  };
  const auto seconds = fall.seconds();
  return {
      {"lost", fall.was_lost},
      {"map_in_view_after_s", after(fall.slowest.seen_ns)},
      {"tracking_after_s", after(fall.slowest.found_ns)},
      {"time_to_tracking_s", seconds ? nlohmann::ordered_json(*seconds) : nlohmann::ordered_json()},
      {"known_frames_since_loss", fall.since_loss.frames},
      {"of_them_with_a_pose", fall.since_loss.posed},
      {"known_frames_once_up", fall.once_up.frames},
      {"of_these_with_a_pose", fall.once_up.posed},
      {"wrong_poses", fall.wrong},
      {"worst_from_truth_m", fall.worst_from_truth_m}};
}

/// From the truth to the map, by the frames located before the fall: a map is bent by some
/// centimetres from end to end, and a camera is located among the things around it. They must agree
/// with the map as a whole, otherwise that decides (`by_map`).
Eigen::Isometry3d mapFromTruth(const Trajectory& truth, const std::vector<StatusRow>& rows,
                               std::int64_t fall_ns, const Eigen::Isometry3d& by_map) {
  Trajectory before;
  for (const StatusRow& row : rows) {
    if (row.has_pose && row.stamp_ns < fall_ns) before.push_back({row.stamp_ns, row.T_map_camera});
  }
  const auto pairs = matchPoses(truth, before);
  if (pairs.empty()) return by_map;
  const Eigen::Isometry3d by_frames = alignPoses(pairs).inverse();
  const Eigen::Isometry3d& T_truth_camera = pairs.back().truth.T_world_camera;
  const Eigen::Isometry3d step = (by_map * T_truth_camera).inverse() * by_frames * T_truth_camera;
  return isWithin(step, kSamePlace_m, kSamePlace_rad) ? by_frames : by_map;
}

/// What is true of each frame since the first fall, brought into the map.
std::vector<FallFrame> framesOf(const Options& options, const SavedMap& saved,
                                std::int64_t first_fall_ns) {
  const bool is_own = options.map_sequence.empty();
  const SequenceTruth truth = loadSequenceTruth(options.sequence);
  const SequenceTruth of_map = is_own ? truth : loadSequenceTruth(options.map_sequence);
  const std::int64_t until_ns = is_own ? first_fall_ns : INT64_MAX;
  const std::vector<StatusRow> rows = loadStatus(options.status);
  const Eigen::Isometry3d T_map_truth = mapFromTruth(
      truth.trajectory, rows, first_fall_ns,
      alignPoses(matchPoses(of_map.trajectory, mappedPoses(saved, until_ns))).inverse());
  SurfelMap map{MapConfig{}};
  map.restore(saved.surfels, saved.frame);
  if (is_own) {
    const auto mapped = std::count_if(rows.begin(), rows.end(), [&](const StatusRow& row) {
      return (row.outcome == "fused" || row.outcome == "located") && row.stamp_ns < first_fall_ns;
    });
    map.removeIf([&](const SurfelArrays& s, std::size_t i) { return s.created[i] >= mapped; });
  }
  const auto true_poses = truthOf(truth.trajectory, rows);
  Judge judge(map);
  const auto source = openTumFolder(options.sequence);
  DepthCorrector corrector(fieldOf(saved.calibration));
  std::vector<FallFrame> frames;
  auto row = rows.begin();
  while (auto next = source->next()) {
    while (row != rows.end() && row->stamp_ns < next->frame.stamp_ns) ++row;
    if (row == rows.end() || row->stamp_ns != next->frame.stamp_ns) continue;
    if (!next->defect.empty()) continue;
    const auto pose = true_poses.find(row->stamp_ns);
    if (row->stamp_ns < first_fall_ns || pose == true_poses.end()) continue;
    const Eigen::Isometry3d T_map_camera = T_map_truth * pose->second;
    next->frame.depth = corrector.inMetres(next->frame.depth, next->frame.depth_unit_m);
    frames.push_back(judge.judge(*row, next->frame, T_map_camera));
    frames.back().blurred = std::binary_search(truth.facts.blurred_ns.begin(),
                                               truth.facts.blurred_ns.end(), row->stamp_ns);
  }
  return frames;
}

int fallCheck(const Options& options) {
  const RecordedEvents events = loadEvents(options.sequence + "/events.json");
  const auto& falls = events.fall_starts_ns;
  if (falls.empty()) throw InputError(options.sequence + "/events.json: has no fall");
  const auto frames = framesOf(options, readSavedMap(options.map), falls.front());
  for (const FallFrame& f : frames) {
    if (!options.each) break;
    std::fprintf(stderr, "%s %s %.2f in the map%s, %.3f m %.1f deg off, %.3f m from the truth\n",
                 formatStamp(f.stamp_ns).c_str(),
                 f.lost       ? "lost"
                 : f.tracking ? "tracking"
                              : "-",
                 f.overlap, f.blurred ? ", blurred" : "", f.error_m, f.error_rad / kDegree,
                 f.from_truth_m);
  }
  auto out = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < falls.size(); ++i) {
    const std::int64_t end_ns = i + 1 < falls.size() ? falls[i + 1] : INT64_MAX;
    std::vector<FallFrame> of_fall;
    std::copy_if(frames.begin(), frames.end(), std::back_inserter(of_fall),
                 [&](const auto& f) { return f.stamp_ns >= falls[i] && f.stamp_ns < end_ns; });
    out.push_back(toJson(checkReturn(of_fall, events.fall_ends_ns[i]), falls[i]));
  }
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{"How soon a camera came back after a fall.", "posefusion_fall_check"};
  pf::Options options;
  app.addOption("sequence", options.sequence, "TUM folder with truth and events")->required();
  app.addOption("status", options.status, "table of posefusion_run --save-status")->required();
  app.addOption("--map", options.map, "map file (*.pfdb) of the run")->required();
  app.addOption("--map-sequence", options.map_sequence,
                "TUM folder that the map was made of; default: the run made it");
  app.addFlag("--each", options.each, "report each frame since the first fall, on stderr");
  return pf::runTool(app, argc, argv, [&] { return pf::fallCheck(options); });
}

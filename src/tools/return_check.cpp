// SPDX-License-Identifier: BSD-3-Clause
// For the bench: how soon a camera is found in a map made before. "Starts" begin anywhere in a
// recording, with no idea where; "falls" know a place, see nothing for a while, and see again from
// up to 0.8 m and 90 degrees away. The map is not changed; a pose is wrong where it is not the one
// that the frame has in the map. Falls are cuts in the recording: what
// the camera sees while it falls is left out.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/slam/pipeline.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr double kNanosecond = 1e-9, kDegree = M_PI / 180.0;
constexpr double kMostWait_s = 5.0;  // a camera that is not found for so long is given up
constexpr double kCovered_s = 1.0;
constexpr double kLeastFall_m = 0.2, kMostFall_m = 0.8, kMostFall_rad = 90 * kDegree;
constexpr double kShortestCut_s = 2.0, kLongestCut_s = 15.0;
constexpr double kWrong_m = 0.10, kWrong_rad = 5 * kDegree;

struct Options {
  std::string sequence, map;
  int starts = 20, falls = 20;
  unsigned seed = 1;
};

/// A stretch of the recording; a fall is one from `known` to `begin`.
struct Trial {
  std::optional<std::size_t> known;  ///< frame from which the camera is to be found first
  std::size_t begin = 0;             ///< frame that is to be found
};

struct Answer {
  double seconds = 0;  ///< until `tracking`
  double error_m = 0, error_rad = 0;
  bool found = false;
  bool isWrong() const { return error_m > kWrong_m || error_rad > kWrong_rad; }
};

/// The frames of the recording, forwards only, and where the map says that they were taken.
class Recording {
 public:
  Recording(const Options& options, const SavedMap& map)
      : source_(openTumFolder(options.sequence)), stamps_ns_(listTumFrames(options.sequence)) {
    for (const FrameRecord& frame : map.frames) {
      poses_[frame.stamp_ns] = pf::poseOf(frame.pose, map.keyframes);
    }
    const auto known = std::count_if(stamps_ns_.begin(), stamps_ns_.end(),
                                     [&](std::int64_t stamp) { return poses_.count(stamp) > 0; });
    if (2 * known < static_cast<std::int64_t>(stamps_ns_.size())) {
      throw InputError(options.map + ": knows " + std::to_string(known) + " frames of " +
                       options.sequence + ", expected a map of that recording");
    }
  }

  std::size_t size() const { return stamps_ns_.size(); }
  double timeOf(std::size_t i) const { return kNanosecond * static_cast<double>(stamps_ns_[i]); }

  /// The pose of a frame in the map; nothing where it was not located.
  std::optional<Eigen::Isometry3d> poseOf(std::size_t i) const {
    const auto found = poses_.find(stamps_ns_[i]);
    return found == poses_.end() ? std::nullopt : std::optional(found->second);
  }

  /// Frame `index`, which must not lie before the last one asked for.
  std::optional<SourceFrame> read(std::size_t index) {
    std::optional<SourceFrame> frame;
    while (next_ <= index) {
      frame = source_->next();
      ++next_;
      if (!frame) return frame;
    }
    return frame;
  }

  RecordedPeople people() { return source_->people(); }

 private:
  std::unique_ptr<FrameSource> source_;
  std::vector<std::int64_t> stamps_ns_;
  std::map<std::int64_t, Eigen::Isometry3d> poses_;
  std::size_t next_ = 0;
};

/// The places of `count` trials, a part of the recording each; falls end where they may.
std::vector<Trial> chooseTrials(const Recording& recording, int count, bool falls, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Trial> trials;
  const std::size_t part = recording.size() / static_cast<std::size_t>(std::max(1, count));
  for (int k = 0; k < count; ++k) {
    const std::size_t first = static_cast<std::size_t>(k) * part + random() % (part / 4 + 1);
    if (!falls) {
      trials.push_back({std::nullopt, first});
      continue;
    }
    const auto from = recording.poseOf(first);
    std::vector<std::size_t> ends;
    for (std::size_t i = first; from && i < recording.size(); ++i) {
      const double later_s = recording.timeOf(i) - recording.timeOf(first);
      if (later_s > kLongestCut_s) break;
      const auto to = recording.poseOf(i);
      if (later_s < kShortestCut_s || !to) continue;
      const Eigen::Isometry3d step = from->inverse() * *to;
      if (step.translation().norm() > kLeastFall_m && isWithin(step, kMostFall_m, kMostFall_rad)) {
        ends.push_back(i);
      }
    }
    if (!ends.empty()) trials.push_back({first, ends[random() % ends.size()]});
  }
  return trials;
}

/// One trial at work.
class Searcher {
 public:
  Searcher(const SavedMap& map, Recording& recording)
      : recording_(recording),
        pipeline_(config(), makePoseDetector(config().pose, recording.people())) {
    pipeline_.load(map, MapUse::localize_only);
  }

  /// Shows frames from `begin` on until the camera is found.
  Answer find(std::size_t begin) {
    Answer answer;
    for (std::size_t i = begin; i < recording_.size(); ++i) {
      answer.seconds = recording_.timeOf(i) - recording_.timeOf(begin);
      if (answer.seconds > kMostWait_s) break;
      const auto frame = recording_.read(i);
      if (!frame || !frame->defect.empty()) continue;
      last_ = frame->frame;
      const FrameStatus status = pipeline_.process(last_).status;
      const auto mapped = recording_.poseOf(i);
      if (status.state != TrackingState::tracking || !mapped) continue;
      const Eigen::Isometry3d error = mapped->inverse() * status.T_map_camera;
      answer.error_m = error.translation().norm();
      answer.error_rad = angleOf(error);
      answer.found = true;
      break;
    }
    return answer;
  }

  /// Covers the camera.
  void cover() {
    RgbdFrame dark = last_;
    dark.depth = cv::Mat::zeros(dark.depth.size(), dark.depth.type());
    for (double s = 0; s < kCovered_s; s += 1.0 / 30) {
      dark.stamp_ns += 33'333'333;
      pipeline_.process(dark);
    }
  }

 private:
  static Config config() {
    Config config;
    config.pose.detector = "recorded";
    return config;
  }

  Recording& recording_;
  Pipeline pipeline_;
  RgbdFrame last_;
};

nlohmann::ordered_json summaryOf(const std::vector<Answer>& answers) {
  std::vector<double> seconds;
  int wrong = 0;
  nlohmann::ordered_json each = nlohmann::ordered_json::array();
  for (const Answer& a : answers) {
    seconds.push_back(a.found ? a.seconds : kMostWait_s);
    wrong += a.found && a.isWrong() ? 1 : 0;
    each.push_back({a.found, a.seconds, a.error_m, a.error_rad / kDegree});
  }
  if (seconds.empty()) return {{"trials", 0}};
  const ErrorStatistics s = statisticsOf(seconds);
  const auto found =
      std::count_if(answers.begin(), answers.end(), [](const Answer& a) { return a.found; });
  return {{"trials", answers.size()}, {"found", found},   {"wrong", wrong},
          {"median_s", s.median},     {"worst_s", s.max}, {"each", each}};
}

std::vector<Answer> answersTo(const std::vector<Trial>& trials, const SavedMap& map,
                              const Options& options) {
  Recording recording(options, map);
  std::vector<Answer> answers;
  for (const Trial& trial : trials) {
    Searcher searcher(map, recording);
    if (trial.known) {
      if (!searcher.find(*trial.known).found) continue;  // counted among the starts
      searcher.cover();
    }
    answers.push_back(searcher.find(trial.begin));
    std::cerr << "frame " << trial.begin << ": " << (answers.back().found ? "" : "not ")
              << "found after " << answers.back().seconds << " s, " << answers.back().error_m
              << " m off\n";
  }
  return answers;
}

int returnCheck(const Options& options) {
  const SavedMap map = readSavedMap(options.map);
  const Recording recording(options, map);
  const auto starts = chooseTrials(recording, options.starts, false, options.seed);
  const auto falls = chooseTrials(recording, options.falls, true, options.seed);
  const nlohmann::ordered_json out = {{"starts", summaryOf(answersTo(starts, map, options))},
                                      {"falls", summaryOf(answersTo(falls, map, options))}};
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{"How soon a camera is found in a map made before.",
                      "posefusion_return_check"};
  pf::Options options;
  app.addOption("sequence", options.sequence, "TUM folder, of which the map was made")->required();
  app.addOption("--map", options.map, "map file (*.pfdb)")->required();
  app.addOption("--starts", options.starts)->check(pf::nonNegative());
  app.addOption("--falls", options.falls)->check(pf::nonNegative());
  app.addOption("--seed", options.seed, "of the places tried");
  return pf::runTool(app, argc, argv, [&] { return pf::returnCheck(options); });
}

// SPDX-License-Identifier: BSD-3-Clause
// For the bench: how well a place is found again in a map. The frames before a time are fused at
// their true poses, people taken out by the recording's masks; later frames are looked for.
#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/loop/place_search.hpp"
#include "posefusion/loop/verify.hpp"
#include "posefusion/map/fusion.hpp"
#include "posefusion/map/render.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr double kRight_m = 0.25, kRight_deg = 10.0;

struct Options {
  std::string sequence;
  double map_until_s = 9.0, query_from_s = 13.5, query_until_s = 1e9, query_step_s = 0.5;
  int fuse_every = 1;
  bool wide = false;
};

/// A frame with its true pose, people out of its depth.
struct TrueFrame {
  WorkingFrame frame;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  double time_s = 0;
};

/// The recording, frame by frame, with what is true of it.
class Recording {
 public:
  explicit Recording(const Options& options)
      : folder_(options.sequence), source_(openTumFolder(folder_)), truth_(source_->truth()) {
    if (truth_.empty()) throw InputError(folder_ + ": has no true poses");
  }

  /// Prepares the next frame for which `wanted(seconds since the first)` holds.
  template <typename Wanted>
  bool next(const Wanted& wanted, TrueFrame& out) {
    while (auto read = source_->next()) {
      const std::int64_t stamp_ns = read->frame.stamp_ns;
      if (first_ns_ < 0) first_ns_ = stamp_ns;
      out.time_s = 1e-9 * static_cast<double>(stamp_ns - first_ns_);
      const auto pose = poseAt(truth_, stamp_ns);
      if (!read->defect.empty() || !pose || !wanted(out.time_s)) continue;
      out.T = *pose;
      const auto path = std::filesystem::path(folder_) / "mask" / (formatStamp(stamp_ns) + ".png");
      cv::Mat mask;
      if (std::filesystem::exists(path)) mask = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
      if (!mask.empty()) read->frame.depth.setTo(0, mask > 0);
      out.frame.assign(read->frame, mask, FrameConfig{});
      return true;
    }
    return false;
  }

 private:
  std::string folder_;
  std::unique_ptr<FrameSource> source_;
  Trajectory truth_;
  std::int64_t first_ns_ = -1;
};

double degreesBetween(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return logSo3(a.linear().transpose() * b.linear()).norm() * 180.0 / M_PI;
}

bool isRight(const Eigen::Isometry3d& T, const Eigen::Isometry3d& truth) {
  return (T.translation() - truth.translation()).norm() < kRight_m &&
         degreesBetween(T, truth) < kRight_deg;
}

/// Part of the frame's pixels with depth where the map shows something from the true pose.
double overlapOf(const SurfelMap& map, const TrueFrame& query) {
  ModelView view;
  RenderOptions options;
  options.age = SurfelAge::all;
  options.only_stable = true;
  SurfelRenderer().render(map, query.frame.camera, query.T, options, view);
  cv::Mat known = (query.frame.depth_m > 0) & (view.depth_m > 0);
  return static_cast<double>(cv::countNonZero(known)) / std::max(1, query.frame.valid_pixels);
}

constexpr double kTrue_m = 0.1, kTrue_deg = 3.0;  // of an accepted place

/// Verifies all candidates: what became of them, and each one in a line for choosing limits.
nlohmann::ordered_json verifyAll(const SurfelMap& map, const TrueFrame& query,
                                 const std::vector<PlaceCandidate>& candidates) {
  PlaceVerifier verifier{TrackingConfig{}};
  int first_right = 0, right = 0, wrong = 0;
  nlohmann::ordered_json each = nlohmann::ordered_json::array();
  const std::clock_t begin = std::clock();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const PlaceVerdict v = verifier.verify(map, query.frame, candidates[i].pose);
    const Eigen::Isometry3d& T = v.alignment.T_map_camera;
    const double off_m = (T.translation() - query.T.translation()).norm();
    const double off_deg = degreesBetween(T, query.T);
    const bool is_true = off_m < kTrue_m && off_deg < kTrue_deg;
    if (v.accepted()) ++(is_true ? right : wrong);
    if (v.accepted() && is_true && first_right == 0) first_right = static_cast<int>(i) + 1;
    const PlaceAgreement& a = v.agreement;
    each.push_back({off_m, off_deg, std::string(name(v.doubt)), a.overlap, a.agreeing,
                    a.seen_through, a.hidden, a.correlation, v.alignment.converged,
                    v.alignment.free_directions, candidates[i].score});
  }
  const double cpu_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const PlaceVerdict best = verifier.verifyBest(map, query.frame, candidates);
  const bool best_true =
      (best.alignment.T_map_camera.translation() - query.T.translation()).norm() < kTrue_m &&
      degreesBetween(best.alignment.T_map_camera, query.T) < kTrue_deg;
  return {{"best", std::string(name(best.doubt))},
          {"best_true", best_true},
          {"first_right", first_right},
          {"right", right},
          {"wrong", wrong},
          {"cpu_ms_each", cpu_ms / std::max<double>(1, static_cast<double>(candidates.size()))},
          {"each", each}};
}

nlohmann::ordered_json searchOne(const SurfelMap& map, const MapPoints& points,
                                 const TrueFrame& query, const Eigen::Isometry3d& last,
                                 const Eigen::Vector3d& up, const PlaceSearchConfig& config) {
  const std::clock_t begin = std::clock();
  const PlaceQuery small = placeQuery(query.frame, last.linear().transpose() * up);
  const auto candidates = searchPlaces(points, small, {kFirstFragment, last}, up, config);
  const double search_ms = 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  int rank = 0;
  for (std::size_t i = 0; i < candidates.size() && rank == 0; ++i) {
    if (isRight(candidates[i].pose.T_map_camera, query.T)) rank = static_cast<int>(i) + 1;
  }
  const Eigen::Isometry3d step = last.inverse() * query.T;
  nlohmann::ordered_json out = {{"time_s", query.time_s},
                                {"overlap", overlapOf(map, query)},
                                {"moved_m", step.translation().norm()},
                                {"turned_deg", degreesBetween(last, query.T)},
                                {"rose_m", up.dot(query.T.translation() - last.translation())},
                                {"rank", rank},
                                {"candidates", candidates.size()},
                                {"search_cpu_ms", search_ms}};
  if (small.floor) {
    const Eigen::Vector3d up_true = query.T.linear().transpose() * up;
    const Eigen::Vector3d up_last = last.linear().transpose() * up;
    out["tilted_deg"] = std::acos(std::min(1.0, up_last.dot(up_true))) * 180.0 / M_PI;
    out["floor_m"] = small.floor->below_m;
    out["up_error_deg"] = std::acos(std::min(1.0, small.floor->up.dot(up_true))) * 180.0 / M_PI;
  }
  PlaceSearchConfig there = config;
  there.reach_m = 0;
  there.heights_m = {0.0};
  const auto at_truth = searchPlaces(points, small, {kFirstFragment, query.T}, up, there);
  for (const PlaceCandidate& c : at_truth) {
    if (!isRight(c.pose.T_map_camera, query.T)) continue;
    out["true"] = {c.score, c.explained, c.agreeing, c.correlation};
    break;
  }
  if (!candidates.empty()) {
    const PlaceCandidate& c = candidates[0];
    out["best"] = {c.score, c.explained, c.agreeing, c.correlation};
  }
  if (!candidates.empty()) out["best_score"] = candidates[0].score;
  out["verify"] = verifyAll(map, query, candidates);
  if (rank > 0) out["right_score"] = candidates[static_cast<std::size_t>(rank) - 1].score;
  return out;
}

int placeCheck(const Options& options) {
  Recording recording(options);
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  TrueFrame frame;
  Eigen::Isometry3d last = Eigen::Isometry3d::Identity();
  int index = 0;
  const auto early = [&](double t) {
    return t > options.map_until_s || index++ % options.fuse_every == 0;
  };
  while (recording.next(early, frame) && frame.time_s <= options.map_until_s) {
    fuser.fuse(frame.frame, frame.T, map);
    last = frame.T;
  }
  Stopwatch watch;
  const MapPoints points = thinnedPoints(map);
  const double thin_ms = watch.lapMs();
  const auto levels =
      findLevels(orientedPoints(points), last.linear() * -Eigen::Vector3d::UnitY(), 0.9);
  if (!levels) throw InputError(options.sequence + ": no floor in the map");
  std::cerr << "up " << levels->up.transpose() << "\n";
  const PlaceSearchConfig config = options.wide ? wideSearch() : PlaceSearchConfig{};
  nlohmann::ordered_json queries = nlohmann::ordered_json::array();
  double next_s = options.query_from_s;
  Recording later(options);
  while (later.next([&](double t) { return t >= next_s; }, frame)) {
    if (frame.time_s > options.query_until_s) break;
    next_s = frame.time_s + options.query_step_s;
    queries.push_back(searchOne(map, points, frame, last, levels->up, config));
    std::cerr << queries.back().dump() << "\n";
  }
  const nlohmann::ordered_json out = {
      {"points", points.size()}, {"thin_ms", thin_ms}, {"queries", queries}};
  std::cout << out.dump(2) << "\n";
  return 0;
}

int run(int argc, char** argv) {
  CommandLine app{"How well later frames of a recording are found in the map of earlier ones.",
                  "posefusion_place_check"};
  Options options;
  app.addOption("sequence", options.sequence, "TUM folder with true poses")->required();
  app.addOption("--map-until", options.map_until_s, "seconds");
  app.addOption("--fuse-every", options.fuse_every, "of the frames before")->check(positive());
  app.addOption("--from", options.query_from_s, "seconds");
  app.addOption("--until", options.query_until_s, "seconds");
  app.addOption("--step", options.query_step_s, "seconds");
  app.addFlag("--wide", options.wide, "search as after loading a map");
  return runTool(app, argc, argv, [&] { return placeCheck(options); });
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) { return pf::run(argc, argv); }

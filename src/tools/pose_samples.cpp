// SPDX-License-Identifier: BSD-3-Clause
// Right and wrong poses for training/pose_evidence.py. Every other frame of the first part of a
// recording is fused at its true pose, bent a little as drift bends a map; other frames are aligned
// with this map, and with each other, from where the search and the poses propose them. Each
// alignment is a line: what it shows of itself, and how far it is from the truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/loop/keyframe_pair.hpp"
#include "posefusion/loop/place_search.hpp"
#include "posefusion/loop/verify.hpp"
#include "posefusion/map/fusion.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr int kFuseEvery = 2, kSearchEvery = 3, kRepaintEvery = 3;
constexpr std::size_t kMostSearched = 10;
constexpr int kDisplaced = 6;
constexpr double kShift_m = 0.2, kTurn_rad = 6 * kDegree, kTilt_rad = 2 * kDegree;
constexpr std::size_t kPairsOfView = 4;
constexpr double kPairs_m = 1.2, kPairs_rad = 25 * kDegree;
constexpr double kElsewhere_m = 0.7, kElsewhere_rad = 40 * kDegree;
constexpr double kLeastGap = 0.06, kMostGap = 0.5;  // part of the picture's width
constexpr double kMaskSeen = 0.6;  // part of the frames in which people are taken out

struct Options {
  std::string sequence;
  double map_share = 0.6;
  double bend_m = 0.02, bend_deg = 0.5, bend_s = 25.0;
  int query_every = 4;
  unsigned seed = 1;
};

/// A frame, and where it is in the bent map.
struct TrueFrame {
  WorkingFrame frame;
  WorkingFrame through_gap;  ///< most of it covered, as by people near the camera
  WorkingFrame repainted;    ///< with the picture of another place: a room of the same shape
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  bool is_masked = true;
};

/// What drift adds to the poses of a map: slow, and never far.
class Bend {
 public:
  Bend(const Options& options, std::mt19937& chance) : options_(options) {
    std::uniform_real_distribution<double> phase(0.0, 2 * M_PI);
    for (double& p : phases_) p = phase(chance);
  }

  Eigen::Isometry3d at(double seconds) const {
    Vector6d twist;
    for (int i = 0; i < 6; ++i) {
      const double size = i < 3 ? options_.bend_m : options_.bend_deg * kDegree;
      const double slower = 1.0 + 0.2 * i;
      twist[i] = size / std::sqrt(3.0) *
                 std::sin(2 * M_PI * seconds / (slower * options_.bend_s) +
                          phases_[static_cast<std::size_t>(i)]);
    }
    return expSe3(twist);
  }

 private:
  const Options& options_;
  std::array<double, 6> phases_{};
};

/// The recording, frame by frame, with the true poses as the map has them.
class Recording {
 public:
  Recording(const Options& options, std::mt19937& chance)
      : options_(options),
        chance_(chance),
        bend_(options, chance),
        truth_(openTumFolder(options.sequence)->truth()),
        frames_(listTumFrames(options.sequence).size()) {
    if (truth_.empty()) throw InputError(options.sequence + ": has no true poses");
  }

  std::size_t size() const { return frames_; }

  /// Calls `use(index, frame)` for the frames of which `isWanted(index)`.
  template <typename Wanted, typename Use>
  void forEach(const Wanted& isWanted, const Use& use) {
    const auto source = openTumFolder(options_.sequence);
    TrueFrame out;
    for (std::size_t index = 0; auto read = source->next(); ++index) {
      const std::int64_t stamp_ns = read->frame.stamp_ns;
      const auto pose = poseAt(truth_, stamp_ns);
      if (!isWanted(index) || !read->defect.empty() || !pose) continue;
      const double seconds = 1e-9 * static_cast<double>(stamp_ns - truth_.front().stamp_ns);
      out.T_map_camera = *pose * bend_.at(seconds);
      takeOutPeople(read->frame, out);
      use(index, out);
    }
  }

  /// People stay in some of the frames from now on: a detector misses them.
  void missSome() { all_masked_ = false; }

 private:
  void takeOutPeople(RgbdFrame& frame, TrueFrame& out) {
    const auto path =
        std::filesystem::path(options_.sequence) / "mask" / (formatStamp(frame.stamp_ns) + ".png");
    cv::Mat mask;
    const bool is_seen =
        all_masked_ || std::uniform_real_distribution<double>()(chance_) < kMaskSeen;
    if (is_seen && std::filesystem::exists(path)) {
      mask = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
    }
    if (!mask.empty()) frame.depth.setTo(0, mask > 0);
    out.is_masked = is_seen;
    out.frame.assign(frame, mask, FrameConfig{});
    RgbdFrame changed = frame;
    changed.depth = frame.depth.clone();
    cover(changed.depth);
    out.through_gap.assign(changed, mask, FrameConfig{});
    repaint(frame, out.T_map_camera);
    out.repainted.assign(frame, mask, FrameConfig{});
  }

  /// Leaves an upright gap.
  void cover(cv::Mat& depth) {
    std::uniform_real_distribution<double> width(kLeastGap, kMostGap), place;
    const int open = static_cast<int>(width(chance_) * depth.cols);
    const int from = static_cast<int>(place(chance_) * (depth.cols - open));
    depth.colRange(0, from).setTo(0);
    depth.colRange(from + open, depth.cols).setTo(0);
  }

  void repaint(RgbdFrame& frame, const Eigen::Isometry3d& T_map_camera) {
    const bool is_elsewhere =
        !isWithin(T_seen_.inverse() * T_map_camera, kElsewhere_m, kElsewhere_rad);
    if (color_.empty() || is_elsewhere) {
      other_color_ = color_.empty() ? frame.color : color_;
      color_ = frame.color;
      T_seen_ = T_map_camera;
    }
    frame.color = other_color_;
  }

  const Options& options_;
  std::mt19937& chance_;
  Bend bend_;
  Trajectory truth_;
  std::size_t frames_;
  cv::Mat color_, other_color_;  ///< of about here, and of where the camera was before
  Eigen::Isometry3d T_seen_ = Eigen::Isometry3d::Identity();
  bool all_masked_ = true;
};

/// A pose beside the given one, as those that are proposed are.
Eigen::Isometry3d displaced(const Eigen::Isometry3d& T, double part, std::mt19937& chance) {
  std::normal_distribution<double> normal;
  const double size = part * std::abs(normal(chance));
  Vector6d twist;
  for (int i = 0; i < 3; ++i) twist[i] = kShift_m * size * normal(chance);
  twist[3] = kTilt_rad * size * normal(chance);
  twist[4] = kTurn_rad * size * normal(chance);
  twist[5] = kTilt_rad * size * normal(chance);
  return T * expSe3(twist);
}

void printHeader() {
  std::fputs("kind,off_m,off_deg", stdout);
  for (std::size_t i = 0; i < kPoseSigns; ++i) {
    std::printf(",%s", std::string(name(static_cast<PoseSign>(i))).c_str());
  }
  std::puts("");
}

/// Nothing of alignments that are not known: they are rejected whatever else they show.
void print(const char* kind, const PlaceVerdict& verdict, const Eigen::Isometry3d& truth) {
  if (!isKnown(verdict.alignment)) return;
  const Eigen::Isometry3d off = truth.inverse() * verdict.alignment.T_map_camera;
  std::printf("%s,%.4f,%.3f", kind, off.translation().norm(), angleOf(off) / kDegree);
  for (const double sign : poseSigns(verdict.alignment, verdict.agreement)) {
    std::printf(",%.4f", sign);
  }
  std::puts("");
}

/// Aligns frames with the map from displaced poses and from those that the search proposes.
class MapSampler {
 public:
  MapSampler(const SurfelMap& map, const Eigen::Isometry3d& last, std::mt19937& chance)
      : map_(map), points_(thinnedPoints(map)), last_(last), chance_(chance) {
    const auto levels =
        findLevels(orientedPoints(points_), last.linear() * -Eigen::Vector3d::UnitY(), 0.9);
    if (levels) up_ = levels->up;
  }

  void sample(const TrueFrame& query) {
    for (int i = 0; i < kDisplaced; ++i) {
      const double part = static_cast<double>(i) / (kDisplaced / 2);
      const WorkingFrame& frame = i == 1 ? query.through_gap : query.frame;
      align(i == 1 ? "gap" : "map", frame, query.T_map_camera,
            displaced(query.T_map_camera, part, chance_));
    }
    if (up_ && queries_ % kSearchEvery == 0) search(query);
    if (queries_++ % kRepaintEvery == 1) alignRepainted(query);
  }

 private:
  void search(const TrueFrame& query) {
    // The search is local: the camera was seen last somewhere near.
    Eigen::Isometry3d around = displaced(query.T_map_camera, 1.5, chance_);
    around.linear() = query.T_map_camera.linear();
    const PlaceQuery small = placeQuery(query.frame, around.linear().transpose() * *up_);
    auto places = searchPlaces(points_, small, {kFirstFragment, around}, *up_, {});
    places.resize(std::min(places.size(), kMostSearched));
    for (const PlaceCandidate& place : places)
      align("search", query.frame, query.T_map_camera, place.pose.T_map_camera);
  }

  /// As wrong as any other place: nowhere near the truth.
  void alignRepainted(const TrueFrame& query) {
    const Eigen::Isometry3d far(Eigen::Translation3d(99, 0, 0));
    align("repainted", query.repainted, far * query.T_map_camera, query.T_map_camera);
  }

  void align(const char* kind, const WorkingFrame& frame, const Eigen::Isometry3d& truth,
             const Eigen::Isometry3d& guess) {
    print(kind, verifier_.verify(map_, frame, {kFirstFragment, guess}), truth);
  }

  const SurfelMap& map_;
  MapPoints points_;
  Eigen::Isometry3d last_;
  std::mt19937& chance_;
  std::optional<Eigen::Vector3d> up_;
  PlaceVerifier verifier_{TrackingConfig{}};
  int queries_ = 0;
};

/// Aligns frames with each other, as keyframes are.
class PairSampler {
 public:
  explicit PairSampler(std::mt19937& chance) : chance_(chance) {}

  void sample(const TrueFrame& query, std::int64_t id) {
    const MapPose pose{kFirstFragment, query.T_map_camera};
    to_.assign(keyframeView(query.frame, id, pose, query.is_masked), query.frame.sensor);
    std::vector<std::size_t> order(views_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::shuffle(order.begin(), order.end(), chance_);
    std::size_t taken = 0;
    for (const std::size_t i : order) {
      const Eigen::Isometry3d T = views_[i].pose.T_map_camera.inverse() * query.T_map_camera;
      if (taken == kPairsOfView) break;
      if (!isWithin(T, kPairs_m, kPairs_rad)) continue;
      align(views_[i], query, T, displaced(T, static_cast<double>(taken), chance_));
      ++taken;
    }
    // What looks alike and is another place begins as if it were the same.
    if (!order.empty()) {
      const KeyframeView& other = views_[order.front()];
      align(other, query, other.pose.T_map_camera.inverse() * query.T_map_camera,
            Eigen::Isometry3d::Identity());
    }
    views_.push_back(keyframeView(query.frame, id, pose, query.is_masked));
  }

 private:
  void align(const KeyframeView& from, const TrueFrame& to, const Eigen::Isometry3d& truth,
             const Eigen::Isometry3d& guess) {
    from_.assign(from, to.frame.sensor);
    print("pair", aligner_.align(from_, to_, guess), truth);
  }

  std::mt19937& chance_;
  PairAligner aligner_{TrackingConfig{}};
  KeyframePicture from_, to_;
  std::vector<KeyframeView> views_;
};

int poseSamples(const Options& options) {
  std::mt19937 chance(options.seed);
  Recording recording(options, chance);
  const auto mapped =
      static_cast<std::size_t>(options.map_share * static_cast<double>(recording.size()));
  SurfelMap map{MapConfig{}};
  Fuser fuser;
  Eigen::Isometry3d last = Eigen::Isometry3d::Identity();
  recording.forEach([&](std::size_t i) { return i < mapped && i % kFuseEvery == 0; },
                    [&](std::size_t, const TrueFrame& frame) {
                      fuser.fuse(frame.frame, frame.T_map_camera, map);
                      last = frame.T_map_camera;
                    });
  recording.missSome();
  MapSampler with_map(map, last, chance);
  PairSampler with_each_other(chance);
  printHeader();
  const auto every = static_cast<std::size_t>(options.query_every);
  // Odd frames, none of which is in the map.
  recording.forEach([&](std::size_t i) { return i % (2 * every) == 1; },
                    [&](std::size_t i, const TrueFrame& frame) {
                      with_map.sample(frame);
                      with_each_other.sample(frame, static_cast<std::int64_t>(i));
                    });
  return 0;
}

int run(int argc, char** argv) {
  CommandLine app{"Right and wrong alignments of a recording's frames, one a line (CSV).",
                  "posefusion_pose_samples"};
  Options options;
  app.addOption("sequence", options.sequence, "TUM folder with true poses and masks")->required();
  app.addOption("--map-share", options.map_share, "part of the recording that is mapped");
  app.addOption("--bend", options.bend_m, "how far drift bends the map, m");
  app.addOption("--query-every", options.query_every, "of the odd frames")->check(positive());
  app.addOption("--seed", options.seed, "of displacements and missed people");
  return runTool(app, argc, argv, [&] { return poseSamples(options); });
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) { return pf::run(argc, argv); }

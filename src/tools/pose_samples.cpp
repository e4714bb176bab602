// SPDX-License-Identifier: BSD-3-Clause
// Right and wrong poses for training/pose_evidence.py. Every other frame of the first part of a
// recording is fused at its true pose, bent a little as drift bends a map; other frames are aligned
// with this map, and with each other, from where the search and the poses propose them. Each
// alignment is a line: what it shows of itself, and how far it is from the truth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "bent_recording.hpp"
#include "posefusion/core/se3.hpp"
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

struct Options {
  std::string sequence;
  double map_share = 0.6;
  BendOptions bend;
  int query_every = 4;
  unsigned seed = 1;
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
      : map_(map), points_(pointPyramid(thinnedPoints(map))), last_(last), chance_(chance) {
    const auto levels =
        findLevels(orientedPoints(points_.front()), last.linear() * -Eigen::Vector3d::UnitY(), 0.9);
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
  PointPyramid points_;
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
  BentRecording recording(options.sequence, options.bend, chance);
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
  app.addOption("--bend", options.bend.shift_m, "how far drift bends the map, m");
  app.addOption("--query-every", options.query_every, "of the odd frames")->check(positive());
  app.addOption("--seed", options.seed, "of displacements and missed people");
  return runTool(app, argc, argv, [&] { return poseSamples(options); });
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) { return pf::run(argc, argv); }

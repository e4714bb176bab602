// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/worker.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/stopwatch.hpp"
#include "posefusion/loop/dense_pairs.hpp"
#include "posefusion/loop/own_view.hpp"

namespace pf {
namespace {

// Where no floor was mapped, the camera's own idea of up has to do.
constexpr double kUpright_rad = 0.7;
// Lower or more tilted than this the last pose is not one that the camera stands in.
constexpr double kStandingHeight_m = 0.2, kStandingTilt_rad = 0.2;
// Candidates that are verified; the same place may come from several searches.
constexpr std::size_t kVerified = 6, kVerifiedElsewhere = 12;

/// Those of a fragment.
std::vector<Eigen::Isometry3d> posesIn(int fragment, const std::vector<MapPose>& poses) {
  std::vector<Eigen::Isometry3d> own;
  for (const MapPose& pose : poses) {
    if (pose.fragment == fragment) own.push_back(pose.T_map_camera);
  }
  return own;
}

/// Up in the map, by how the camera was held at its keyframes: the last pose may be of a fall.
Eigen::Vector3d meanUpright(const std::vector<Eigen::Isometry3d>& keyframes,
                            const Eigen::Isometry3d& T_map_last) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Isometry3d& T : keyframes) sum -= T.linear().col(1);
  if (sum.norm() < 0.5 * static_cast<double>(keyframes.size())) sum.setZero();  // held anyhow
  return sum.isZero() ? Eigen::Vector3d(-T_map_last.linear().col(1)) : sum.normalized();
}

/// Where the camera would stand at the place of its last pose, as it does at the nearest keyframe.
/// Nothing where it stands already.
std::optional<Eigen::Isometry3d> standing(const std::vector<Eigen::Isometry3d>& keyframes,
                                          const Eigen::Isometry3d& T_map_last,
                                          const Eigen::Vector3d& up) {
  const auto far = [&](const Eigen::Isometry3d& T) {
    return (T.translation() - T_map_last.translation()).squaredNorm();
  };
  const auto nearest =
      std::min_element(keyframes.begin(), keyframes.end(),
                       [&](const auto& a, const auto& b) { return far(a) < far(b); });
  if (nearest == keyframes.end()) return std::nullopt;
  const double higher_m = up.dot(nearest->translation() - T_map_last.translation());
  const Eigen::Vector3d a = nearest->linear().transpose() * up;
  const Eigen::Vector3d b = T_map_last.linear().transpose() * up;
  if (std::abs(higher_m) < kStandingHeight_m && a.dot(b) > std::cos(kStandingTilt_rad)) {
    return std::nullopt;
  }
  Eigen::Isometry3d T = *nearest;
  T.translation() = T_map_last.translation() + higher_m * up;
  return T;
}

}  // namespace

LoopWorker::LoopWorker(const LoopConfig& config, const TrackingConfig& tracking,
                       const DepthSensor& sensor, const CalibrationConfig& calibration)
    : config_(config),
      tracking_(tracking),
      sensor_(sensor),
      calibration_(calibration),
      closer_(config, tracking, sensor),
      verifier_(tracking) {}

void LoopWorker::begin() {
  closer_ = LoopCloser(config_, tracking_, sensor_);
  learner_ = FieldLearner();
}

void LoopWorker::beginMap() {
  begin();
  LoopCounts searches;
  searches.searched = counts_.searched;
  searches.found = counts_.found;
  counts_ = searches;
}

void LoopWorker::addKeyframe(const KeyframeView& view) {
  closer_.addKeyframe(view);
  if (!calibration_.learns()) return;
  learner_.add(calibrationView(view, sensor_));
}

void LoopWorker::learn(const LoopQuestion& question, LoopAnswer& answer) {
  answer.depth_version = question.depth_version;
  if (!calibration_.learns() || !(question.keyframe || question.calibrates)) return;
  const std::optional<DepthCalibration>& known = question.calibration;
  const DepthField field = fieldOf(known);
  const auto estimate = question.calibrates ? std::optional<FieldEstimate>(learner_.estimate(field))
                                            : learner_.learn(field);
  if (!estimate) return;
  answer.calibration_doubt = estimate->doubtBeside(known);
  if (!answer.calibration_doubt.empty()) return;
  answer.calibration = estimate->asCalibration();
}

LoopAnswer LoopWorker::answer(const LoopQuestion& question) {
  LoopAnswer answer;
  if (question.known) {
    counts_.addWork(closer_.counts());
    begin();
    for (const KeyframeView& view : *question.known) addKeyframe(view);
  }
  closer_.forget(question.retired);
  if (!question.corrected.empty()) {
    closer_.setPoses(question.corrected);
    learner_.setPoses(question.corrected);
  }
  answer.remeasured = closer_.remeasure(question.remeasured);
  if (question.keyframe) {
    if (question.keyframe->id == 0) beginMap();
    Stopwatch watch;
    addKeyframe(*question.keyframe);
    if (question.step) {
      for (const PoseConstraint& step : closer_.remeasure({*question.step})) answer.step = step;
    }
    if (question.seeks_loops) answer.loops = closer_.findLoops();
    answer.verification_ms = watch.lapMs();
  }
  learn(question, answer);
  if (question.place) {
    answer.asked_for_place = true;
  }
  if (question.place && !(question.place_is_void && *question.place_is_void)) {
    answer.place = findPlace(*question.place);
    ++counts_.searched;
    counts_.found += answer.place ? 1 : 0;
  }
  answer.counts = closer_.counts();
  answer.counts.addWork(counts_);
  return answer;
}

std::optional<PlaceVerdict> LoopWorker::findPlace(const PlaceQuestion& question) {
  if (!canBePlaced(question.frame, tracking_)) return std::nullopt;
  // Features are the fastest where they find the place; drawing the map finds the rest.
  std::vector<PlaceCandidate> like;
  for (const MapPose& pose : closer_.placesLike(keyframeView(question.frame, 0, {}, true))) {
    if (question.admits(pose)) like.emplace_back().pose = pose;
  }
  const PlaceVerdict soon =
      verifier_.verifyBest(*question.map, question.frame, like, kVerified, question.expected.get());
  if (!like.empty() && soon.accepted()) return soon;
  std::size_t most = 0;
  const std::vector<PlaceCandidate> candidates = searchAll(question, most);
  if (candidates.empty()) return std::nullopt;
  PlaceVerdict verdict = verifier_.verifyBest(*question.map, question.frame, candidates, most,
                                              question.expected.get());
  if (!verdict.accepted()) return std::nullopt;
  return verdict;
}

std::vector<PlaceCandidate> LoopWorker::searchAll(const PlaceQuestion& question,
                                                  std::size_t& most) {
  const MapPose& last = question.last;
  std::vector<MapPose> places = {last};
  places.insert(places.end(), question.elsewhere.begin(), question.elsewhere.end());
  const auto T_standing = standing(posesIn(last.fragment, closer_.poses()), last.T_map_camera,
                                   searched(question, last).up);
  if (T_standing) places.push_back({last.fragment, *T_standing});
  most = places.size() == 1 ? kVerified : kVerifiedElsewhere;
  const PlaceQuery query = placeQuery(question.frame);
  std::vector<PlaceCandidate> candidates;
  for (const MapPose& around : places) {
    if (!question.admitsNear(around)) continue;
    const Searched& in = searched(question, around);
    if (in.points.front().size() == 0) continue;
    const auto more = searchPlaces(in.points, query, around, in.up, {});
    std::copy_if(more.begin(), more.end(), std::back_inserter(candidates),
                 [&](const PlaceCandidate& c) { return question.admits(c.pose); });
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  return candidates;
}

const LoopWorker::Searched& LoopWorker::searched(const PlaceQuestion& question,
                                                 const MapPose& around) {
  if (map_.lock() != question.map) {
    map_ = question.map;
    searched_.clear();
  }
  const auto [found, is_new] = searched_.try_emplace(around.fragment);
  Searched& s = found->second;
  if (!is_new) return s;
  s.points = pointPyramid(thinnedPoints(*question.map, around.fragment));
  const Eigen::Vector3d upright =
      meanUpright(posesIn(around.fragment, closer_.poses()), around.T_map_camera);
  const auto levels = findLevels(orientedPoints(s.points.front()), upright, kUpright_rad);
  s.up = levels ? levels->up : upright;
  return s;
}

}  // namespace pf

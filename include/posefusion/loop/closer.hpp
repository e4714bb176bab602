// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <vector>

#include "posefusion/graph/constraint.hpp"
#include "posefusion/loop/config.hpp"
#include "posefusion/loop/features.hpp"
#include "posefusion/loop/ferns.hpp"
#include "posefusion/loop/keyframe_pair.hpp"

namespace pf {

/// A measured relative pose of two keyframes.
struct LoopConstraint {
  std::int64_t from = 0, to = 0;  ///< keyframes
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (m, rad) in the camera frame of `to`

  PoseConstraint asPoseConstraint() const {
    return {static_cast<int>(from), static_cast<int>(to), T_from_to, covariance,
            ConstraintKind::loop};
  }
};

/// Counts of loop closing and relocalisation, for the summary.
struct LoopCounts {
  std::size_t keyframes = 0;
  std::size_t ferns = 0;       ///< keyframes whose ferns are stored
  std::size_t not_static = 0;  ///< keyframes whose ferns the static-view rule kept out
  std::size_t compared = 0;    ///< pairs that were verified
  std::size_t accepted = 0;
  std::size_t local = 0;  ///< of the accepted: of keyframes near by the poses; the rest is global
  std::array<std::size_t, kPlaceDoubts> refused{};  ///< by PlaceDoubt
  std::size_t one_way = 0;                          ///< refused: the two directions do not agree
  std::size_t turned = 0;                           ///< refused: the pictures look different ways
  std::size_t searched = 0;  ///< frames of a lost camera that were searched for
  std::size_t found = 0;     ///< of them: relocalised

  std::size_t allRefused() const;

  /// Adds the work of before; keyframes and ferns are those that are known now.
  void addWork(const LoopCounts& before);
};

/// Finds pairs of keyframes that see the same place. Candidates come from the ferns, from nearness
/// by the poses and from features; each is verified by aligning either picture with the other. Not
/// thread safe.
class LoopCloser {
 public:
  /// `sensor`: that took all keyframes.
  LoopCloser(const LoopConfig& config, const TrackingConfig& tracking, const DepthSensor& sensor);

  /// Ids rise. Ferns are stored by their rules, the view in any case.
  void addKeyframe(const KeyframeView& view);

  /// Closes no more loops to these keyframes (ascending); unknown ones are ignored.
  void forget(const std::vector<int>& ids);

  /// New poses after a correction: of keyframe i at place i. Throws InputError when there are fewer
  /// than the last id requires.
  void setPoses(const std::vector<MapPose>& poses);

  /// Where in the map a picture may have been taken (camera poses, not verified): its features
  /// matched with those of the keyframes whose ferns are most alike.
  std::vector<MapPose> placesLike(const KeyframeView& view);

  /// Verified constraints from older keyframes to the last one added: at most one for each, and no
  /// more than are enough. The nearest come first: depth that is off by a few percent spoils a
  /// constraint by as much of the way between the two.
  std::vector<LoopConstraint> findLoops();

  /// Constraints between known keyframes, measured anew from where they are: those whose pictures
  /// still agree.
  std::vector<PoseConstraint> remeasure(const std::vector<PoseConstraint>& constraints) const;

  /// Of the keyframes, as last set.
  std::vector<MapPose> poses() const;

  const LoopCounts& counts() const { return counts_; }
  const FernDatabase& ferns() const { return ferns_; }

 private:
  struct Keyframe {
    KeyframeView view;
    FernCode code;
    std::optional<Features> features;  ///< found when they are first asked for
  };
  /// An older keyframe that may see what the last one sees.
  struct Candidate {
    std::size_t index = 0;
    double far = 0;  ///< by the poses, m and rad together
    Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();  ///< guess
    bool is_local = false;  ///< near by the poses, not only by the picture
  };

  std::vector<Candidate> candidates() const;
  static const Features& featuresOf(Keyframe& keyframe);
  /// Verifies it with the last keyframe, by the guess and, where that fails, by features.
  std::optional<LoopConstraint> verify(const Candidate& candidate);
  std::optional<LoopConstraint> verify(std::int64_t id, const Eigen::Isometry3d& T_from_to_guess);

  LoopConfig config_;
  TrackingConfig tracking_;
  DepthSensor sensor_;
  PairAligner aligner_;
  KeyframePicture from_, to_;  ///< a candidate, and the last keyframe
  std::deque<Keyframe> keyframes_;
  FernDatabase ferns_;
  LoopCounts counts_;
};

}  // namespace pf

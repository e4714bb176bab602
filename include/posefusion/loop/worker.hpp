// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/calibration/config.hpp"
#include "posefusion/calibration/depth_calibration.hpp"
#include "posefusion/calibration/field_learner.hpp"
#include "posefusion/graph/constraint.hpp"
#include "posefusion/graph/expected_place.hpp"
#include "posefusion/loop/closer.hpp"
#include "posefusion/loop/map_points.hpp"
#include "posefusion/loop/place_search.hpp"

namespace pf {

/// A frame of a lost camera, and the map that it may lie in.
struct PlaceQuestion {
  WorkingFrame frame;                    ///< shares no memory with the frame at work
  std::shared_ptr<const SurfelMap> map;  ///< as it was when the camera was lost
  MapPose last{};                        ///< before the loss
  /// Further poses around which to look, in a map that was loaded.
  std::vector<MapPose> elsewhere{};
  /// Where the camera can be at all; nothing: anywhere.
  std::shared_ptr<const ExpectedPlace> expected{};

  bool admits(const MapPose& place) const { return !expected || expected->admits(place); }
  /// Whether anything that a search around it finds can be admitted.
  bool admitsNear(const MapPose& around) const {
    return !expected || expected->admitsNear(around, PlaceSearchConfig{}.farthest_m());
  }
};

/// What mapping asks of the loop closer. Immutable once asked: it is worked on in another thread.
struct LoopQuestion {
  std::int64_t stamp_ns = 0;             ///< of the frame that asks
  std::optional<KeyframeView> keyframe;  ///< number 0 begins a new map
  /// By which the keyframe was tracked from another, to be measured by their pictures.
  std::optional<PoseConstraint> step;
  /// The keyframes of a map just loaded, as far as their images are known: what was before is
  /// forgotten.
  std::optional<std::vector<KeyframeView>> known;
  /// Keyframes that others now represent: their pictures are forgotten.
  std::vector<int> retired{};
  /// Of all keyframes before this one, in their order, when a correction has moved them; else
  /// empty.
  std::vector<MapPose> corrected;
  std::shared_ptr<const PlaceQuestion> place;
  /// Set by the asking thread once the camera is located again: relocalisation is then skipped.
  std::shared_ptr<const std::atomic<bool>> place_is_void{};
  /// Whether to search loops of the keyframe; else it is only added.
  bool seeks_loops = true;
  /// How often the depth of the keyframes has been corrected by what was learned.
  int depth_version = 0;
  /// The correction of the keyframes' depth; none: it is as measured.
  std::optional<DepthCalibration> calibration{};
  /// Constraints between known keyframes that are to be measured anew, as their depth has changed.
  std::vector<PoseConstraint> remeasured{};
  bool calibrates = false;  ///< asked for: the camera's field is estimated now

  /// A question for a place alone, answered before the questions that wait, from what is known
  /// then.
  bool is_urgent = false;

  /// Whether there is anything beside the lost camera.
  bool tellsMore() const {
    return keyframe || step || known || !retired.empty() || !corrected.empty() ||
           !remeasured.empty() || calibrates;
  }
};

/// The answer of the loop closer.
struct LoopAnswer {
  std::vector<LoopConstraint> loops;   ///< of the keyframe
  std::optional<PoseConstraint> step;  ///< of the question, measured by its pictures
  /// Time to find and verify them all; 0 without a keyframe, or where it was not measured.
  double verification_ms = 0;
  bool asked_for_place = false;
  std::optional<PlaceVerdict> place;  ///< of the lost frame, where it was found
  LoopCounts counts;                  ///< since the beginning
  /// The present error of the depth camera, where it is worth correcting.
  std::optional<DepthCalibration> calibration;
  int depth_version = 0;          ///< of the question
  std::string calibration_doubt;  ///< why an estimate is not worth it; empty: there is none
  std::vector<PoseConstraint> remeasured;  ///< those that the pictures still agree on
};

/// The loop closer's work, question by question: loops of keyframes, the error of the depth camera,
/// and relocalisation by drawing the map around the last pose before the loss (searchPlaces) and
/// verifying the best candidates. The answers depend on the questions and their order alone. Not
/// thread safe; may work beside the mapper.
class LoopWorker {
 public:
  LoopWorker(const LoopConfig& config, const TrackingConfig& tracking, const DepthSensor& sensor,
             const CalibrationConfig& calibration = {});

  LoopAnswer answer(const LoopQuestion& question);

 private:
  /// A fragment of the map that was last searched in.
  struct Searched {
    PointPyramid points;
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
  };

  /// The keyframes, from the first on.
  void begin();
  void beginMap();
  void addKeyframe(const KeyframeView& view);
  void learn(const LoopQuestion& question, LoopAnswer& answer);
  std::optional<PlaceVerdict> findPlace(const PlaceQuestion& question);
  /// Candidates around all poses of the question, best first, and how many (`most`) are worth
  /// verifying.
  std::vector<PlaceCandidate> searchAll(const PlaceQuestion& question, std::size_t& most);
  /// The fragment of a pose to look around, from the map of the question.
  const Searched& searched(const PlaceQuestion& question, const MapPose& around);

  LoopConfig config_;
  TrackingConfig tracking_;
  DepthSensor sensor_;
  CalibrationConfig calibration_;
  LoopCloser closer_;
  FieldLearner learner_;
  PlaceVerifier verifier_;
  LoopCounts counts_;  ///< of lost cameras; of pairs, before the keyframes were sent anew
  // Of the map that was last searched in.
  std::weak_ptr<const SurfelMap> map_;  ///< that those fragments are of
  std::map<int, Searched> searched_;
};

}  // namespace pf

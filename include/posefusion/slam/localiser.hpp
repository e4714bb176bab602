// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/loop/verify.hpp"
#include "posefusion/robot/motion_prior.hpp"
#include "posefusion/slam/recent_motion.hpp"
#include "posefusion/slam/status.hpp"
#include "posefusion/slam/verdict.hpp"
#include "posefusion/tracking/rotation.hpp"
#include "posefusion/tracking/tracker.hpp"

namespace pf {

/// The map as rendered from a pose, ready for tracking.
struct RenderedModel {
  const ModelPyramid& points;
  Eigen::Isometry3d T_map_view;
};

/// Renders the map from about this pose: the answer may be of another pose nearby. Valid until the
/// next call.
using ModelRenderer = std::function<RenderedModel(const Eigen::Isometry3d& T_map_camera)>;
/// Renders the map from exactly this pose. Valid until the next call, of a ModelRenderer too.
using ViewRenderer = std::function<const ModelView&(const Eigen::Isometry3d& T_map_camera)>;
struct MapRenderers {
  ModelRenderer model;
  ViewRenderer view;
};

/// The pose of a frame, and how far it is trusted.
struct Location {
  TrackingState state = TrackingState::initializing;
  FrameOutcome outcome = FrameOutcome::fused;  ///< `fused`: it may be
  bool located = false;
  bool is_return = false;         ///< relocalised with this frame
  bool is_recent_return = false;  ///< relocalised a short time ago: it must not harm the map
  int fragment = kFirstFragment;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();  ///< in the fragment
  TrackingResult tracking;
  /// Of the pose, against those of the last second: what they have in common, as far as they saw
  /// the same, shows in no motion between them. Alignments are weighted by tracking.covariance.
  Matrix6d covariance = Matrix6d::Zero();
  SparseMotion motion;
  /// From the frame before: by corners, by the robot's other sensors, or by both; nothing without
  /// either.
  std::optional<MotionPrior> step;
  bool has_odometry = false;  ///< the robot's odometry is part of it
  /// Where the camera would be by these steps alone since the last fused frame; measured where
  /// many corners or the robot's odometry showed each. Of a return, it shows the drift during the
  /// loss.
  PosePrior carried;
  std::string detail;

  MapPose pose() const { return {fragment, T_map_camera}; }
};

/// Finds each frame in the map: a prior from the corners' motion and the robot's other sensors (or
/// constant velocity without either), alignment from it and, where that fails, from other starts,
/// and a verdict. Carries the pose by dead reckoning while alignment fails. Relocalisation takes
/// proof over several frames. Works in one fragment of the map at a time. Not thread safe.
class Localiser {
 public:
  explicit Localiser(const TrackingConfig& config);

  /// The first frame of a map, or of a fragment of it: what was before is forgotten.
  Location begin(const WorkingFrame& frame, std::int64_t stamp_ns, const MapPose& pose,
                 const Brightness& brightness = {});

  /// Starts lost in a loaded map, last known at `pose`. The grey levels of the map follow from
  /// those of frames by `brightness`.
  void beginLost(const MapPose& pose, const Brightness& brightness);

  /// Any later frame. `flow` leads to it from the frame before; `view` is the map from the pose of
  /// the last fused frame; `render` draws fragment(). A `forced` frame (see BlurScore) is not
  /// trusted enough to be fused. `told`: the motion since lastStamp() measured by the robot's other
  /// sensors.
  Location locate(const WorkingFrame& frame, std::int64_t stamp_ns, const SparseFlow& flow,
                  bool forced, const ModelView& view, const MapRenderers& render,
                  const std::optional<MotionPrior>& told = std::nullopt);

  std::int64_t lastStamp() const { return previous_.stamp_ns; }

  TrackingState state() const { return state_; }
  /// While lost: the last frames speak for some place.
  bool isProving() const { return belief_ > 0; }
  /// Between the map and the last frame that was believed.
  const Brightness& brightness() const { return brightness_; }
  /// The last pose of a located frame.
  const MapPose& lastPose() const { return located_; }
  /// The fragment to search the next frame in: that of the last pose or, while lost, of a suggested
  /// one.
  int fragment() const { return previous_.fragment; }

  /// The pose by the corners' motion alone since the beginning: it gives the motion between two
  /// frames even while the camera is lost.
  const Eigen::Isometry3d& reckonedPose() const { return T_reckoned_; }

  /// Follows a correction of the map, which moves lastPose() by `T_new_old` and into `fragment`. A
  /// place suggested in another fragment than that is given up.
  void move(const Eigen::Isometry3d& T_new_old, int fragment);

  /// Depth is corrected by one more step from the next frame on.
  void correctDepth(DepthCorrector& step);

  /// While lost: the camera was at `place` when reckonedPose() was `T_reckoned`. Later frames
  /// have to confirm it.
  void suggest(const PlaceVerdict& place, const Eigen::Isometry3d& T_reckoned);

  /// From the next frame on; what is known stays.
  void set(const TrackingConfig& config) { config_ = config; }

  void reset() { *this = Localiser(config_); }

 private:
  /// The frame before: what the next prediction starts from.
  struct Previous {
    std::int64_t stamp_ns = 0;
    int fragment = kFirstFragment;
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    Matrix6d covariance =
        Matrix6d::Zero();  ///< twist in the camera frame, since the last trusted one
    /// The same relative to what was in view, most of which was mapped a moment before and lies
    /// where that moment's error put it.
    Matrix6d covariance_to_view = Matrix6d::Zero();
    Vector6d velocity = Vector6d::Zero();  ///< twist per second, camera frame
    std::int64_t velocity_ns = 0;          ///< when it was measured; 0: it was not
    Matrix6d velocity_covariance = Matrix6d::Zero();
    cv::Mat depth_m;  ///< full size
    SmallImage small;

    void forgetVelocity() {
      velocity.setZero();
      velocity_ns = 0;
    }
  };

  /// Of a frame: when it was taken, and whether it is sharp.
  struct Moment {
    std::int64_t stamp_ns = 0;
    bool forced = false;  ///< the frame is blurred
  };

  /// Writes the motion since the frame before to `location`; returns the prediction that follows.
  PosePrior expect(const WorkingFrame& frame, std::int64_t stamp_ns, const SparseFlow& flow,
                   const ModelView* view, const std::optional<MotionPrior>& told,
                   Location& location);
  const ModelView* viewBefore(const SparseFlow& flow, const ModelView& last,
                              const ViewRenderer& render) const;
  SparseMotion measure(const WorkingFrame& frame, std::int64_t stamp_ns, const SparseFlow& flow,
                       const ModelView* view) const;
  /// T_before_after as the camera moved before.
  Eigen::Isometry3d atConstantVelocity(double elapsed_s) const;
  PosePrior predict(const Location& location, double elapsed_s) const;
  /// A place to start from, and little more: of a lost camera images alone have to say where it
  /// is. The way that it was carried along may have gone astray, by corners on people above all.
  static PosePrior startAt(const Eigen::Isometry3d& T_map_camera);
  /// An alignment, and what is thought of it.
  struct Attempt {
    TrackingResult result;
    Verdict verdict;

    bool isBelieved() const { return verdict.outcome == FrameOutcome::fused; }
  };
  Attempt align(const WorkingFrame& frame, bool forced, const PosePrior& prior,
                const MapRenderers& render) const;
  Attempt alignFrom(const Eigen::Isometry3d& guess, bool firm, const WorkingFrame& frame,
                    bool forced, const PosePrior& prior, const MapRenderers& render) const;
  Attempt withoutSlip(const Attempt& found, const WorkingFrame& frame, const PosePrior& prior,
                      const MapRenderers& render) const;
  bool mustBeProven(const Attempt& attempt, bool forced) const;
  bool isProven(const WorkingFrame& frame, const Attempt& attempt,
                const MapRenderers& render) const;
  void carry(const MotionPrior& step, bool is_known);
  bool isReckonedWell(const Location& location, const PosePrior& prior, double reckoned_s) const;
  void trust(Location& location, std::int64_t stamp_ns, double elapsed_s);
  void distrust(Location& location, const PosePrior& prior, std::int64_t stamp_ns);
  /// Further checks of a frame that tracking found good. Where little is in view its position must
  /// be known as well as at a searched place; after a gap the images must prove the pose as they
  /// do at one: one plane (a ceiling, in a fall) slides as it likes.
  Verdict askFurther(const WorkingFrame& frame, const Location& location, const PosePrior& prior,
                     const Moment& moment, const ViewRenderer& render) const;
  void prove(const WorkingFrame& frame, const PosePrior& prior, Location& location,
             const ViewRenderer& render);
  void gatherEvidence(const WorkingFrame& frame, const PosePrior& prior, const Location& location,
                      const ViewRenderer& render);
  void goBackToLast();
  void remember(const WorkingFrame& frame, const SparseFlow& flow, const PosePrior& prior,
                const Location& location, std::int64_t stamp_ns);

  TrackingConfig config_;
  Pace pace_;  ///< of the last frame
  TrackingState state_ = TrackingState::initializing;
  Previous previous_;
  PosePrior carried_;  ///< see Location
  Landmarks landmarks_;
  MapPose located_;  ///< see lastPose()
  Eigen::Isometry3d T_reckoned_ = Eigen::Isometry3d::Identity();
  RecentMotion recent_;
  Brightness brightness_;
  std::int64_t trusted_ns_ = 0;  ///< stamp of the last frame that may be fused
  std::int64_t seen_ns_ = 0;     ///< of the last that was located by its images, blurred ones too
  int untrusted_in_a_row_ = 0;
  int reckoned_in_a_row_ = 0;  ///< of those, located by dead reckoning
  /// While lost: log-odds that the pose which is carried along is right; 0: no place is known.
  double belief_ = 0;
  bool is_suggested_ = false;  ///< the pose comes from a place just found
  int frames_since_return_ = 1 << 20;
};

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/map/fusion.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/robot/gravity.hpp"
#include "posefusion/robot/robot_motion.hpp"
#include "posefusion/slam/localiser.hpp"
#include "posefusion/slam/mapper.hpp"
#include "posefusion/slam/reckoning.hpp"

namespace pf {

constexpr std::int64_t kBeforeAll = std::numeric_limits<std::int64_t>::min();

/// Where a fragment would lie in another.
struct FragmentPlace {
  LoopConstraint constraint;
  int other = kFirstFragment;
  Eigen::Isometry3d T_other_fragment;
};

/// A view of the map that is still to be drawn.
struct WantedView {
  MapPose pose;
  std::int64_t stamp_ns = 0;  ///< see ModelView
  bool fill = false;          ///< the last frame was fused there
};

/// What is wanted of the map, and not yet in work.
struct WantedCorrection {
  std::vector<PoseConstraint> loops, remeasured;
  std::optional<DepthCalibration> depth;

  bool isEmpty() const { return loops.empty() && remeasured.empty() && !depth; }
};

/// The mapper's parts: frames are located and fused in mapper.cpp; what is asked of the loop closer
/// and what its answers want stands in mapper_loops.cpp, how the map follows in
/// mapper_corrections.cpp, fragments in mapper_fragments.cpp.
struct Mapper::State {
  explicit State(const Config& c)
      : config(c),
        sensor(depthSensorOf(c)),
        map(c.map, SurfelMap::kBlockSide_m, sensor),
        localiser(c.tracking),
        robot(c.robot),
        back_end(c.graph) {}

  Config config;
  DepthSensor sensor;
  SurfelMap map;
  std::optional<Eigen::Isometry3d> T_world_map;
  Localiser localiser;
  RobotMotion robot;
  GravityEstimate gravity;  ///< in the first fragment
  Eigen::Isometry3d T_map_start = Eigen::Isometry3d::Identity();
  PinholeCamera camera;            ///< of the frames of the map, full size
  bool sees_other_camera = false;  ///< the last frame was of another one
  PaceMeter pace_meter;
  WorkingFrame frame;
  cv::Mat input_depth_m;                  ///< of the frame, before people were taken out
  std::optional<WantedView> wanted_view;  ///< until drawn: what is corrected meanwhile is seen too
  ModelView view, elsewhere;              ///< from the last trusted pose, from another guess
  ModelPyramid model, model_elsewhere;
  const ModelView nothing;
  Fuser fuser;
  SurfelRenderer renderer;
  std::int64_t last_stamp_ns = kBeforeAll;
  BackEnd back_end;
  std::optional<LoopQuestion> question;
  bool keyframes_moved = false;     ///< since the last question
  std::vector<KeyframeView> views;  ///< of the keyframes in use
  std::vector<int> retired;         ///< keyframes, since the last question
  bool closer_is_old = false;       ///< does not know yet of the map that was loaded
  bool may_change = true;           ///< the map
  std::vector<MapPose> rooms;       ///< of a loaded map until it is found: where to look
  std::size_t next_room = 0;
  std::optional<MapPose> hint;  ///< a user's hint of the camera's place, until it is found
  // Of the depth camera.
  std::optional<DepthCalibration> calibration;  ///< nothing: depth is taken as measured
  DepthCorrector corrector{DepthField()};       ///< by it
  int depth_version = 0;                        ///< how often it was learned anew
  bool is_calibration_loaded = false;           ///< of an earlier recording, and unchanged
  bool constraints_are_old = false;             ///< measured with depth as it was before
  bool calibration_is_asked = false;
  std::string last_calibration;
  DepthCorrector distorter{DepthField()};  ///< the other way round
  ModelView seen;                          ///< `view` with the camera's own error
  /// All corrections so far, see ModelView.
  Eigen::Isometry3d T_map_uncorrected = Eigen::Isometry3d::Identity();

  // Of corrections.
  WantedCorrection wanted;
  std::vector<std::pair<PoseConstraint, int>> wanted_steps;  ///< with the depth's version
  bool is_correcting = false;                                ///< one is in work
  std::uint64_t correction_number = 0;                       ///< of it
  std::vector<std::uint32_t> unswept;  ///< blocks where one surface may lie double, ascending
  int frames_to_sweep = 0;             ///< until layers are looked for, if there is nothing else

  // Of the search for a lost camera.
  Reckoning reckoning;  ///< in the first fragment
  std::shared_ptr<const SurfelMap> map_at_loss;
  Eigen::Isometry3d T_reckoned_at_question = Eigen::Isometry3d::Identity();
  bool place_is_asked = false, place_is_stale = false;
  // Of a piece of the map whose place is not known.
  int last_fragment = kFirstFragment;    ///< number of the last one begun
  std::optional<double> lost_s;          ///< while lost: with an open view
  int frames_to_place = 0;               ///< until the next question where the fragment is
  RelativePose at_question;              ///< of the frame that was asked about
  std::optional<FragmentPlace> seen_at;  ///< reported once, not yet twice

  /// That the camera is in or, while lost, was in.
  int fragment() const { return localiser.lastPose().fragment; }
  bool isPlaceKnown() const { return fragment() == kFirstFragment; }

  std::optional<Eigen::Isometry3d> worldFromMap() const;
  std::string defect(const StaticFrame& input) const;
  TrackingState state() const;
  RenderedModel modelFrom(const MapPose& pose);
  const ModelView& viewFrom(const MapPose& pose);
  Location locate(const StaticFrame& input);
  void checkRobot(const Location& location, const std::optional<MapPose>& before,
                  std::int64_t before_ns);
  void fuse(const StaticFrame& input, const Location& location);
  void mayBeDouble(const std::vector<std::uint32_t>& blocks);
  void follow(const Location& location, bool fill);
  void seek(const MapPose& last, Brightness brightness);
  void showFrom(const MapPose& pose, std::int64_t stamp_ns, bool fill);
  void drawView();
  void keep(const StaticFrame& input, const Location& location);
  void tellCloser();
  void endSearch();
  void askForPlace();
  std::optional<MapPose> reckonedPlace() const;
  std::shared_ptr<const SurfelMap> searchedMap() const;
  std::optional<MapPose> trackedPose() const;
  void reckon(const Location& location, const std::optional<MapPose>& before,
              std::int64_t before_ns);
  void countLostTime(const Location& location, std::int64_t before_ns);
  bool isViewOpen() const;
  bool wantsFragment(const StaticFrame& input) const;
  Location beginFragment();
  void askForFragment();
  void placeFragment(const PlaceVerdict& seen);
  std::vector<std::uint32_t> restingUnswept(int since_frame) const;
  std::optional<MapCorrection> beginCorrection(bool all);
  void finishCorrection(CorrectedMap& corrected);
  void finishDepth(DepthImprovement& depth, const std::optional<Deformation>& motion,
                   const std::vector<std::uint32_t>& changed);
  void settle();
  void retireViews(const std::vector<int>& ids);
  void retrack(const PoseConstraint& step, int version);
  void follow(const std::vector<Deformation>& deformations,
              const std::vector<std::uint32_t>& blocks, bool lays_layers);
  void moveView(int fragment, const Eigen::Isometry3d& T_new_old);
  StaticFrame corrected(const StaticFrame& input);
  void use(std::optional<DepthCalibration> known);
  void use(std::optional<DepthCalibration> known, DepthCorrector there, DepthCorrector back);
  DepthSensor sensorWith(const std::optional<DepthCalibration>& known) const;
  DepthImprovement improvementBy(const DepthCalibration& learned) const;
  void take(const LoopAnswer& answer);
  void noteImproved(DepthImprovement& depth);
  void depthHasChanged(DepthCorrector& step);
  void placeViews();
  void alignPairs(Refinement& done);
  std::string learnFromAll();
};

}  // namespace pf

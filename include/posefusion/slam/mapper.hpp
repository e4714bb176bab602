// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "posefusion/calibration/depth_calibration.hpp"
#include "posefusion/core/frame.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/frame/model_view.hpp"
#include "posefusion/loop/worker.hpp"
#include "posefusion/robot/robot_motion.hpp"
#include "posefusion/slam/back_end.hpp"
#include "posefusion/slam/config.hpp"
#include "posefusion/slam/map_correction.hpp"
#include "posefusion/slam/saved_map.hpp"
#include "posefusion/slam/status.hpp"

namespace pf {

class SurfelMap;

/// A frame without its people, as mapping takes it.
struct StaticFrame {
  RgbdFrame frame;      ///< `depth` has no people left in it
  cv::Mat mask;         ///< CV_8UC1, 255 = the color is a person's, and what the map has at its
                        ///< depth was fused by mistake; may be empty
  SparseFlow flow;      ///< corners followed from the sharp frame before
  bool forced = false;  ///< passed the blur gate by force: located at best, not fused

  /// The depth before people were taken out, type of `frame.depth`. May be empty: people who were
  /// mapped then stay, and what is close to people is mapped like the rest.
  cv::Mat input_depth{};
};

/// Owns the map: localises each static frame in it (Localiser) and fuses the trusted ones. Not
/// thread safe.
class Mapper {
 public:
  explicit Mapper(const Config& config);
  ~Mapper();

  FrameStatus process(const StaticFrame& input);

  /// Measurements of the robot's other sensors, in the order of their stamps and before the frames
  /// that it helps: the camera's pose in the frame of the odometry, and inertial samples along the
  /// camera's axes. See RobotMotion for when it is believed. @{
  void addOdometry(const StampedPose& pose);
  void addImu(const ImuSample& sample);
  const RobotMotion& robot() const;
  /// @}

  /// The question to the loop closer after the frame just processed, returned once: about a new
  /// keyframe, or the relocalisation of a lost camera.
  std::optional<LoopQuestion> takeQuestion();

  /// Whether relocalisation helps: the camera is lost, or in a fragment whose place is not known.
  bool isLookedFor() const;

  /// The camera is said to be about here, as seen from above (in the frame of place()), with this
  /// heading: until it is found, it is also searched for there. The place has to be proven as any
  /// other. Height and tilt are those of the nearest keyframe. Returns a sentence on what happens.
  /// Throws InputError without a map, or for a pose that is not finite.
  std::string hint(const Eigen::Isometry3d& T_world_camera);

  /// Another loop closer answers from now on: the next question holds all keyframes.
  void introduceCloser();

  /// Takes in an answer: a loop corrects the map and all poses, see takeCorrection(); a place found
  /// brings a lost camera back, once the next frames agree.
  void take(const LoopAnswer& answer);

  /// The next correction of the map by the answers, for any thread to prepare(). Nothing: none is
  /// due, or the last is still in work.
  std::optional<MapCorrection> takeCorrection();

  /// Applies it between two frames: the map, the graph and all poses follow. A correction of a map
  /// that was reset is left out. Memory to be freed is then in `corrected`.
  void take(CorrectedMap& corrected);

  /// The correction in work has failed.
  void abandonCorrection();

  /// Makes all due corrections at once; one still prepared elsewhere is void.
  void settle();

  /// From the next frame on depth is corrected by this, until mapping knows better; what
  /// reset() begins keeps it. To be called before the first frame; before load(), which takes the
  /// map's own where it has one, and else corrects the map. Throws InputError where
  /// `calibration.mode` is none.
  void calibrate(const DepthCalibration& calibration);

  /// What depth is corrected by now, and how often that was learned anew since the map began.
  /// Nothing: it is taken as measured. @{
  const std::optional<DepthCalibration>& calibration() const;
  int depthVersion() const;
  /// @}

  /// The loop closer is to estimate the camera's error now, with the keyframes there are. Returns
  /// why it cannot, or nothing. See lastCalibration().
  std::string askForCalibration();

  /// The result of the last estimate; empty: there was none.
  const std::string& lastCalibration() const;

  /// What refine() did.
  struct Refinement {
    std::size_t pairs = 0, measured = 0;  ///< of keyframes: compared, and found to agree
    double largest_shift_m = 0;           ///< of a keyframe; 0: nothing has moved
    std::string reason;                   ///< why none was compared; empty: they were

    std::string text() const;  ///< what was done, or why nothing, in a line
  };

  /// The best that the pictures of the keyframes allow: what they all together reveal of the depth
  /// camera is taken in (where mapping learns), then all that see the same surface are aligned with
  /// each other, and the graph, the map and all poses follow. Seconds of work for a hundred
  /// keyframes: for when no frame waits. Nothing is aligned where depth is off by what is not
  /// corrected or not known: two pictures see a place at two sides of the image, and would bend the
  /// map more than tracking, which saw it everywhere. Nothing changes where the map must not.
  Refinement refine();

  /// Continues a saved map: the camera is lost until it is relocalised. Frames must be of the map's
  /// camera. Throws InputError where the map has no keyframe or does not fit together.
  void load(SavedMap map, MapUse use);

  /// The clock was put back: stamps may begin anew. The map goes on; the camera is lost until it is
  /// relocalised. Without a map: as reset().
  void restartClock();

  /// From the next frame on. Throws InputError where there is no map to localise in.
  void setUse(MapUse use);

  /// All that load() needs to go on from here; `camera`: of the frames.
  SavedMap saved(const PinholeCamera& camera) const;

  /// What the keyframes saw, rising by number; those of a loaded map as far as known.
  const std::vector<KeyframeView>& keyframeViews() const;

  /// Between the map and the last frame that was believed.
  const Brightness& brightness() const;

  /// Keyframes, graph, and the poses of all frames as they are known now.
  const BackEnd& backEnd() const;

  /// The status of a frame that is not mapped (blurred, dropped, bad input): the state stays as it
  /// is.
  FrameStatus skip(std::int64_t stamp_ns, FrameOutcome outcome) const;

  /// The map as the depth camera sees it from the last trusted pose, with the camera's own error,
  /// so that depth as measured compares with it: for the segmenter. Empty before the first frame
  /// and while the camera is lost. Drawn when it is first asked for, or with the next frame. The
  /// images are valid until the next call of process(), take() or reset(): clone what must live
  /// longer.
  const ModelView& view() const;

  /// The map rendered from any pose with any camera (color included): pictures, checks.
  ModelView render(const PinholeCamera& camera, const Eigen::Isometry3d& T_map_camera) const;

  const SurfelMap& map() const;

  /// Pace of the frames, as of the last one.
  const Pace& pace() const;

  /// Sets the pose of the map in the user's frame (z up). Nothing in the map changes; its files,
  /// and later sessions in it, keep that frame.
  void place(const Eigen::Isometry3d& T_world_map);

  /// Nothing until place() was called for this map, here or in a session before.
  const std::optional<Eigen::Isometry3d>& placed() const;

  /// The same for files; without place(), gravity (else the first camera) defines what is level.
  Eigen::Isometry3d worldFromMap() const;

  /// From the next frame on. The loop closer keeps what it began with.
  void set(const TrackingConfig& tracking);

  /// Puts known surfels (map frame) into the map, as far as its memory lasts; returns how many.
  /// They count like fused ones, but do not locate the camera: before the first frame the map still
  /// starts at its pose.
  std::size_t add(const SurfelArrays& surfels);

  /// Forgets everything; the next frame starts a new map at `T_map_camera` (identity at first).
  void reset(const Eigen::Isometry3d& T_map_camera = Eigen::Isometry3d::Identity());

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pf

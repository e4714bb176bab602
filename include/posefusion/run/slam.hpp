// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/map/surfels.hpp"
#include "posefusion/slam/config.hpp"
#include "posefusion/slam/outcome.hpp"

namespace pf {

/// What is known of the camera after a frame. The world is the first camera turned to x forward, y
/// left, z up (bodyFromOptical()); poses take the camera's optical axes (x right, y down, z
/// forward) there, in metres.
struct FrameAnswer {
  std::int64_t stamp_ns = 0;
  TrackingState state = TrackingState::initializing;
  FrameOutcome outcome = FrameOutcome::fused;
  bool located = false;  ///< else the pose means nothing
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  /// Of a small motion in the camera's frame, m and rad.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::string reason;  ///< why the frame was not fused; empty: it was
};

/// The whole of posefusion for programs without ROS: colour and depth in, poses and a dense map
/// without the people out. The results are those of posefusion_run, to the bit. One thread at a
/// time may call it; it uses all cores.
class Slam {
 public:
  /// For frames that come one by one. Throws InputError where a setting or a model file is wrong.
  explicit Slam(const Config& config = {});

  /// For a recording: the kind of depth camera and the people that it names are used where the
  /// settings ask for them.
  Slam(Config config, FrameSource& recording);

  Slam(Slam&& other) noexcept;
  Slam& operator=(Slam&& other) noexcept;
  ~Slam();

  /// One frame, whose stamp is later than all before. A frame that cannot be used changes nothing
  /// and says why in the answer.
  FrameAnswer process(const RgbdFrame& frame);

  /// All frames of a recording, read and looked at ahead in threads of their own. `done` is called
  /// in the caller's, after each frame, and returns false to stop; it may be empty. What reading
  /// throws is thrown here, after `done` has seen all frames before it.
  void process(FrameSource& recording, const std::function<bool(const FrameAnswer&)>& done);

  /// After the last frame: waits for loops that are still looked at, and refines the map where the
  /// settings want it. Returns what that did, in a line.
  std::string finish();

  /// Poses of all frames that have one, as loops have corrected them so far, in the world.
  Trajectory trajectory() const;

  /// The stable surfels, in the world. A copy: tens of bytes for each of maybe millions.
  SurfelArrays surfels() const;

  /// TUM format: `stamp tx ty tz qx qy qz qw`. Throws InputError naming the file.
  void saveTrajectory(const std::string& path) const;

  /// Binary PLY of the stable surfels; returns their number. Throws InputError naming the file.
  std::size_t saveMap(const std::string& path) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pf

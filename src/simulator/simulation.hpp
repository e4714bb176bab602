// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "posefusion/core/frame.hpp"
#include "posefusion/core/trajectory.hpp"
#include "posefusion/pose/skeleton.hpp"
#include "simulator/color_sensor.hpp"
#include "simulator/imu.hpp"
#include "simulator/legs.hpp"
#include "simulator/scenario.hpp"
#include "simulator/thing_track.hpp"
#include "simulator/world.hpp"

namespace pf::simulator {

/// What is true of one person in one frame.
struct PersonTruth {
  int id = 0;  ///< 1 + place in the scenario; the value in the mask
  std::string name;
  std::array<Eigen::Vector3d, kJointCount> joints_world_m;
  std::array<Eigen::Vector2d, kJointCount> joints_px;  ///< may lie outside the picture
  std::array<bool, kJointCount> in_view{};  ///< in front of the camera and inside the picture
  std::array<bool, kJointCount> visible{};  ///< and nothing but the person's own surface before it
  int pixels = 0;                           ///< of the mask
};

/// One simulated frame with its truth.
struct SimulatedFrame {
  int index = 0;
  bool dropped = false;  ///< never arrived: only index and stamps are set
  std::int64_t depth_stamp_ns = 0;
  RgbdFrame frame;  ///< stamp_ns is that of the colour image: the middle of its exposure
  cv::Mat mask;     ///< CV_8UC1 at the depth's moment: 0, or the id of the person
  /// CV_8UC1 at the depth's moment: 0, or 1 + number of a thing that moves; empty: there are none.
  cv::Mat thing_mask;
  std::vector<PersonTruth> people;  ///< those with a pixel or a joint in the picture
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< at stamp_ns
  Exposure exposure;
  double smear_px = 0.0;  ///< how far the still world moved in the picture during the exposure
};

/// The camera is in a room that has a name.
struct Visit {
  std::string room;
  double start_s = 0.0;
  double end_s = 0.0;
};

/// What the robot's other sensors say.
struct Senses {
  std::vector<ImuSample> imu;
  std::vector<LegSample> legs;
};

/// A scenario come alive. Frames are asked for in order, because the exposure follows the picture.
class Simulation {
 public:
  /// Builds rooms, light and people (seconds). Throws InputError for impossible geometry: a camera
  /// in a wall, a person's goal outside of all rooms.
  explicit Simulation(const Scenario& scenario);
  ~Simulation();

  int frameCount() const;
  SimulatedFrame frame(int index);
  /// The next frame does not follow the last one: the exposure is found anew.
  void jump();

  /// The camera at the rate of the motion capture, with its noise and gaps, from the start to a
  /// little after the first `frames` frames.
  Trajectory truth(int frames) const;
  /// What happened in that time, cut to it; seconds since the start of the scenario.
  std::vector<Event> events(int frames) const;
  /// What becomes of each thing in that time.
  std::vector<std::vector<ThingChange>> thingChanges(int frames) const;
  /// The poses of a thing in that time, T_world_thing: straight and even between two of them.
  Trajectory thingPoses(std::size_t thing, int frames) const;
  /// The still world with the things as they stand at the last of so many frames.
  Mesh sceneAfter(int frames) const;
  /// Which rooms the camera is in, in that time. A doorway belongs to the room before it.
  std::vector<Visit> visits(int frames) const;
  /// What inertial sensor, legs and neck say in that time. They have random numbers of their own.
  Senses senses(int frames) const;
  std::int64_t stampOf(double time_s) const;
  const World& world() const;
  const std::vector<ThingShape>& things() const;
  const Scenario& scenario() const;

 private:
  /// From the start to a little after the first `frames` frames.
  TimeSpan spanOf(int frames) const;

  struct State;
  std::unique_ptr<State> state_;
};

/// A frame whose picture of the still world moved further than this during the exposure is blurred.
constexpr double kBlurred_px = 5.0;

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <future>

#include "simulator/camera_path.hpp"
#include "simulator/crowd.hpp"
#include "simulator/depth_sensor.hpp"
#include "simulator/renderer.hpp"
#include "simulator/simulation.hpp"

namespace pf::simulator {

/// A view at a moment of the frame, 0..1.
ViewSample viewAt(const Eigen::Isometry3d& T_world_camera, double time);

/// All that a simulation holds, and what a frame is put together from.
struct Simulation::State {
  explicit State(const Scenario& s);

  /// When a frame is taken (seconds of the scenario): the middle of the colour picture, the depth
  /// picture, and from when to when the shutter is open.
  struct Moments {
    int index = -1;
    Exposure exposure;
    double color = 0.0, depth = 0.0, first = 0.0, last = 0.0;

    double within(double time) const { return (time - first) / (last - first); }
  };
  Moments momentsOf(int index, const Exposure& exposure) const;
  bool isDropped(int index) const;
  double smearOf(const Moments& m) const;
  double limbSmearOf(const Moments& m) const;  ///< of hands, feet and things, at the most
  int samplesFor(double smear_px) const;
  ViewCone viewConeOf(const Moments& m) const;
  Shutter shutterFor(const Moments& m, int samples) const;

  /// A frame about to be taken: its people and things posed and lit.
  struct Shot {
    Shot(const RayCaster& world, const std::vector<Avatar>& people,
         const std::vector<ThingShape>& things, const ColorConfig& config)
        : in_color(world, people, things,
                   config.motion_blur || config.rolling_shutter_ms > 0.0 ? 2 : 1),
          in_depth(world, people, things, 1) {}

    Moments moments;
    PosedMovers in_color, in_depth;
    MoverSurfaces surfaces;
    FrameLight light;
  };
  /// The shot of this frame: the one prepared in the background, or prepared now.
  Shot& take(int index);
  /// Begins to prepare a shot while that of take() is drawn. Its exposure is that of now, so it
  /// answers to the pictures up to the last but one, as a camera's does.
  void prepareInBackground(int index);
  void forgetPrepared();
  void prepare(Shot& shot, const Moments& m) const;
  Postures posturesAt(double time) const;
  MoverPoses posesAt(double time) const;
  void placeSurfaces(const Moments& m, const MoverPoses& poses, MoverSurfaces& surfaces) const;

  /// Colour, depth and truth of the shot.
  void draw(const Shot& shot, SimulatedFrame& out);
  void observePeople(const Moments& m, SimulatedFrame& out) const;
  /// Parts what the depth picture shows into people and things that move at its moment.
  void labelMovers(const Moments& m, const cv::Mat& label, SimulatedFrame& out) const;
  /// Lets people and things play their scripts.
  Crowd play(std::vector<ThingTrack>& tracks) const;
  /// What the camera has of things, for those that move when it looks, or looks away.
  ThingWatch watch() const;

  World world;
  Scenario scenario;  // settled in that world
  std::vector<Avatar> people;
  std::vector<ThingShape> things;
  RayCaster caster;
  Lighting lighting;
  std::unique_ptr<CameraPath> path;
  std::vector<ThingTrack> thing_tracks;
  Crowd crowd;
  Renderer renderer;
  ColorSensor color_sensor;
  AutoExposure exposure;
  std::array<Shot, 2> shots;
  std::size_t current = 0;
  cv::Mat radiance, label;
  DepthView view;
  std::future<void> preparing;  // last: ends before what it works on
};

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/simulator/camera_path.hpp"
#include "posefusion/simulator/crowd.hpp"
#include "posefusion/simulator/depth_sensor.hpp"
#include "posefusion/simulator/simulation.hpp"

namespace posefusion::simulator {

/// A view at a moment of the frame, 0..1.
ViewSample viewAt(const Eigen::Isometry3d& T_world_camera, double time);

/// All that a simulation holds, and what a frame is put together from.
struct Simulation::State {
  explicit State(const Scenario& s);

  /// The frame's moments, seconds of the scenario.
  struct Moments {
    double color, depth, first, last;
  };
  Moments momentsOf(int index) const;
  double within(const Moments& m, double time) const {
    return (time - m.first) / (m.last - m.first);
  }
  double smearOf(const Moments& m) const;
  int samplesFor(const Moments& m, double smear_px) const;
  void placePeople(const Moments& m);
  Shutter shutterFor(const Moments& m, int samples) const;
  void observePeople(const Moments& m, SimulatedFrame& out) const;

  Scenario scenario;
  World world;
  std::vector<Avatar> people;
  RayCaster caster;
  Lighting lighting;
  std::unique_ptr<CameraPath> path;
  Crowd crowd;
  Renderer renderer;
  ColorSensor color_sensor;
  AutoExposure exposure;
  std::vector<std::vector<Eigen::Vector3f>> positions, normals;
  cv::Mat radiance;
  DepthView view;
  Exposure now;
};

}  // namespace posefusion::simulator

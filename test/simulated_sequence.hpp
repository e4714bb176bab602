// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/core/frame.hpp"
#include "posefusion/pose/skeleton.hpp"
#include "simulator/scenario.hpp"
#include "simulator/simulation.hpp"
#include "simulator/truth.hpp"

namespace pf {

/// One frame with its exact truth.
struct TrueFrame {
  RgbdFrame frame;
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
  cv::Mat mask;   ///< CV_8UC1, 255 = a person
  People people;  ///< joints as a perfect detector would report them
};

/// The first frames of a scenario of the simulator; "empty_box" and "box_walker" are the small and
/// fast ones. The map frame is the camera frame of frame 0. All frames are drawn at once; after
/// that any thread may read them.
class SimulatedSequence {
 public:
  /// `assignments` change values of the scenario: "depth.noise=false".
  SimulatedSequence(const std::string& scenario, int frames,
                    const std::vector<std::string>& assignments = {}) {
    simulator::ScenarioChanges changes;
    changes.assignments = assignments;
    changes.duration_s = frames / 30.0;
    simulator::Simulation simulation(simulator::loadScenario(scenario, changes));
    const int count = simulation.frameCount();
    for (int i = 0; i < count; ++i) {
      const simulator::SimulatedFrame drawn = simulation.frame(i);
      if (i == 0) T_map_world_ = drawn.T_world_camera.inverse();
      frames_.push_back({drawn.frame, T_map_world_ * drawn.T_world_camera, drawn.mask > 0,
                         simulator::asDetected(drawn)});
    }
  }

  int frameCount() const { return static_cast<int>(frames_.size()); }
  /// A copy, which the caller may damage.
  TrueFrame frame(int index) const {
    TrueFrame copy = at(index);
    copy.frame.color = copy.frame.color.clone();
    copy.frame.depth = copy.frame.depth.clone();
    return copy;
  }
  Eigen::Isometry3d pose(int index) const { return at(index).T_map_camera; }
  std::int64_t stamp(int index) const { return at(index).frame.stamp_ns; }

 private:
  const TrueFrame& at(int index) const { return frames_.at(static_cast<std::size_t>(index)); }

  std::vector<TrueFrame> frames_;
  Eigen::Isometry3d T_map_world_ = Eigen::Isometry3d::Identity();
};

/// The empty box without systematic errors of depth, which turn and stretch any map by some
/// centimetres: its first frames, drawn once in a program.
template <int frames>
const SimulatedSequence& exactBox() {
  static const SimulatedSequence drawn("empty_box", frames, {"depth.distortion=0"});
  return drawn;
}

}  // namespace pf

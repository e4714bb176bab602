// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "simulator/camera_path.hpp"

namespace pf::simulator {

/// A camera that moves by a function.
class FunctionPath : public CameraPath {
 public:
  explicit FunctionPath(std::function<Eigen::Isometry3d(double)> at) : at_(std::move(at)) {}
  Eigen::Isometry3d at(double time_s) const override { return at_(time_s); }

 private:
  std::function<Eigen::Isometry3d(double)> at_;
};

/// A robot that walks along two legs, the second one sideways, and falls where given.
inline std::unique_ptr<CameraPath> walkingRobot(std::vector<Fall> falls = {}) {
  Robot spec;
  spec.waypoints = {{1, 1}, {5, 1}, {Eigen::Vector2d(5, 5), 0.0}};
  spec.repeats = false;
  spec.falls = std::move(falls);
  return makeRobot(spec, 60.0, 3U);
}

}  // namespace pf::simulator

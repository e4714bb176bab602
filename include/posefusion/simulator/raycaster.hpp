// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "posefusion/simulator/world.hpp"

namespace posefusion::simulator {

/// Sixteen rays that travel together. `valid` is -1 for a ray that is asked for, else 0.
struct RayPacket {
  alignas(64) RTCRayHit16 rays;
  alignas(64) int valid[16];
};

/// Rays through the static world (geometry 0) and the people (geometry 1 + index), with Embree.
/// People move linearly between two shapes: time 0 and time 1 of a ray. Tracing is thread safe,
/// changing people is not.
class RayCaster {
 public:
  explicit RayCaster(const Mesh& world);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// Returns the index of the person.
  int addPerson(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                std::size_t vertex_count);

  /// The person's vertices (x y z, metres, world) at time 0 and 1, to be written before
  /// commitPeople().
  float* shape(int person, int time);
  void setVisible(int person, bool visible);
  void commitPeople();

  /// Nearest hits with the world and the people. Geometry IDs of the packet are set here.
  void trace(RayPacket& packet) const;

  /// The nearest hit with the world alone.
  void traceWorld(RTCRayHit& ray) const;

  /// Whether anything lies between the two points, apart from `margin_m` at both ends.
  bool worldBlocks(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float margin_m) const;
  bool peopleBlock(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float margin_m) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace posefusion::simulator

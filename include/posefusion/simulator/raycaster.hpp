// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <embree3/rtcore.h>

#include <memory>

#include "posefusion/simulator/world.hpp"

namespace posefusion::simulator {

/// Sixteen rays that travel together. `valid` is -1 for a ray that is asked for, else 0.
struct RayPacket {
  alignas(64) RTCRayHit16 rays;
  alignas(64) int valid[16];
};

/// Rays through the static world (geometry 0), with Embree. Thread safe.
class RayCaster {
 public:
  explicit RayCaster(const Mesh& world);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// Nearest hits. Geometry IDs of the packet are set here.
  void trace(RayPacket& packet) const;
  void trace(RTCRayHit& ray) const;

  /// Whether anything lies between the two points, apart from `margin_m` at both ends.
  bool blocks(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float margin_m) const;

  /// For others that share the device: valid while this lives.
  RTCDevice device() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace posefusion::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include POSEFUSION_EMBREE

#include <array>
#include <memory>

#include "simulator/world.hpp"

namespace pf::simulator {

/// Sixteen rays that travel together. `valid` is -1 for a ray that is asked for, else 0.
struct RayPacket {
  alignas(64) RTCRayHit16 rays;
  alignas(64) int valid[16];
};

/// Sixteen pairs of points, to be asked whether anything lies between.
struct SightPacket {
  std::array<Eigen::Vector3f, 16> from, to;
  std::array<bool, 16> asked{};
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

  /// Whether anything lies between the points, apart from `margin_m` at both ends; false where not
  /// asked.
  std::array<bool, 16> blocks(const SightPacket& sight, float margin_m) const;

  /// For others that share the device: valid while this lives.
  RTCDevice device() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pf::simulator

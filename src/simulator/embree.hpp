// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "simulator/raycaster.hpp"

namespace pf::simulator {

struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using ScenePointer = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

/// A geometry of triangles with `shapes` buffers for vertices, not committed yet.
RTCGeometry makeTriangles(RTCDevice device,
                          const std::vector<std::array<std::uint32_t, 3>>& triangles,
                          unsigned shapes);

/// Vertices (x y z) of one of its shapes, to be filled.
float* makeVertices(RTCGeometry geometry, unsigned shape, std::size_t count);

/// Builds the scene's tree in one thread: the tree, and with it ties between neighbours, is always
/// the same.
void buildTree(RTCScene scene);

/// Hits in the scene that are nearer than the ray's, or those in the packet.
void intersect(RTCScene scene, RTCRayHit& ray);
void intersect(RTCScene scene, RayPacket& packet);

/// Whether anything in the scene lies between the points, apart from `margin_m` at both ends.
std::array<bool, 16> blocks(RTCScene scene, const SightPacket& sight, float margin_m);

}  // namespace pf::simulator

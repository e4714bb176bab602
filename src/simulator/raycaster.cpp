// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/raycaster.hpp"

#include <limits>
#include <stdexcept>

#include "embree.hpp"

namespace pf::simulator {
namespace {

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};

}  // namespace

struct RayCaster::State {
  // Not "threads=1": that would hold everything that uses TBB in this process to one thread.
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice> device{rtcNewDevice(nullptr)};
  ScenePointer scene;
};

RayCaster::RayCaster(const Mesh& world) : state_(std::make_unique<State>()) {
  State& s = *state_;
  if (!s.device) throw std::runtime_error("Embree cannot be started");
  s.scene.reset(rtcNewScene(s.device.get()));
  RTCGeometry geometry = makeTriangles(s.device.get(), world.triangles, 1);
  float* vertices = makeVertices(geometry, 0, world.positions.size());
  for (const auto& p : world.positions) {
    for (int i = 0; i < 3; ++i) *vertices++ = p[i];
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(s.scene.get(), geometry, 0);
  rtcReleaseGeometry(geometry);
  buildTree(s.scene.get());
}

RayCaster::~RayCaster() = default;

void RayCaster::trace(RayPacket& packet) const {
  for (int i = 0; i < 16; ++i) {
    packet.rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.rays.ray.mask[i] = 0xFFFFFFFFU;
    packet.rays.ray.flags[i] = 0;
  }
  intersect(state_->scene.get(), packet);
}

void RayCaster::trace(RTCRayHit& ray) const {
  ray.ray.tfar = std::numeric_limits<float>::infinity();
  ray.ray.mask = 0xFFFFFFFFU;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect(state_->scene.get(), ray);
}

std::array<bool, 16> RayCaster::blocks(const SightPacket& sight, float margin_m) const {
  return simulator::blocks(state_->scene.get(), sight, margin_m);
}

RTCDevice RayCaster::device() const { return state_->device.get(); }

}  // namespace pf::simulator

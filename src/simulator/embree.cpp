// SPDX-License-Identifier: BSD-3-Clause
#include "embree.hpp"

#include <tbb/task_arena.h>

namespace pf::simulator {

RTCGeometry makeTriangles(RTCDevice device,
                          const std::vector<std::array<std::uint32_t, 3>>& triangles,
                          unsigned shapes) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryTimeStepCount(geometry, shapes);
  auto* target = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), triangles.size()));
  for (const auto& triangle : triangles) {
    for (const std::uint32_t vertex : triangle) *target++ = vertex;
  }
  return geometry;
}

float* makeVertices(RTCGeometry geometry, unsigned shape, std::size_t count) {
  return static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, shape,
                                                     RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
}

void buildTree(RTCScene scene) {
  tbb::task_arena one_thread(1);
  one_thread.execute([scene] { rtcCommitScene(scene); });
}

void intersect(RTCScene scene, RayPacket& packet) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(packet.valid, scene, &context, &packet.rays);
}

std::array<bool, 16> blocks(RTCScene scene, const SightPacket& sight, float margin_m) {
  alignas(64) RTCRay16 ray{};
  alignas(64) int valid[16]{};
  for (std::size_t i = 0; i < 16; ++i) {
    // Where Embree has no packets of 16 it goes by the range of the ray, not by `valid`.
    ray.tfar[i] = -1.0F;
    if (!sight.asked[i]) continue;
    const Eigen::Vector3f& from = sight.from[i];
    const Eigen::Vector3f d = sight.to[i] - from;
    const float length = d.norm();
    if (length <= 2.0F * margin_m) continue;
    valid[i] = -1;
    ray.org_x[i] = from.x(), ray.org_y[i] = from.y(), ray.org_z[i] = from.z();
    ray.dir_x[i] = d.x(), ray.dir_y[i] = d.y(), ray.dir_z[i] = d.z();
    ray.tnear[i] = margin_m / length;
    ray.tfar[i] = 1.0F - margin_m / length;
    ray.time[i] = 0.5F;
    ray.mask[i] = 0xFFFFFFFFU;
    ray.flags[i] = 0;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded16(valid, scene, &context, &ray);
  std::array<bool, 16> blocked;
  for (std::size_t i = 0; i < 16; ++i) blocked[i] = valid[i] != 0 && ray.tfar[i] < 0.0F;
  return blocked;
}

}  // namespace pf::simulator

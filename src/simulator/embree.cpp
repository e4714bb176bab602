// SPDX-License-Identifier: BSD-3-Clause
#include "embree.hpp"

#include <tbb/task_arena.h>

namespace pf::simulator {
namespace {

// What Embree 3 has as a context before the rays, Embree 4 has as arguments after them.
#if RTC_VERSION_MAJOR >= 4
struct Query {
  RTCIntersectArguments intersecting;
  RTCOccludedArguments occluding;
  explicit Query(bool is_coherent = false) {
    rtcInitIntersectArguments(&intersecting);
    rtcInitOccludedArguments(&occluding);
    if (is_coherent) intersecting.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  }
  void intersect(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, &intersecting); }
  void intersect(const int* valid, RTCScene scene, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &rays, &intersecting);
  }
  void occlude(const int* valid, RTCScene scene, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &rays, &occluding);
  }
};
#else
struct Query {
  RTCIntersectContext context;
  explicit Query(bool is_coherent = false) {
    rtcInitIntersectContext(&context);
    if (is_coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  }
  void intersect(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &context, &ray); }
  void intersect(const int* valid, RTCScene scene, RTCRayHit16& rays) {
    rtcIntersect16(valid, scene, &context, &rays);
  }
  void occlude(const int* valid, RTCScene scene, RTCRay16& rays) {
    rtcOccluded16(valid, scene, &context, &rays);
  }
};
#endif

}  // namespace

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

void intersect(RTCScene scene, RTCRayHit& ray) { Query().intersect(scene, ray); }

void intersect(RTCScene scene, RayPacket& packet) {
  Query(true).intersect(packet.valid, scene, packet.rays);
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
  Query().occlude(valid, scene, ray);
  std::array<bool, 16> blocked;
  for (std::size_t i = 0; i < 16; ++i) blocked[i] = valid[i] != 0 && ray.tfar[i] < 0.0F;
  return blocked;
}

}  // namespace pf::simulator

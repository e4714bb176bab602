// SPDX-License-Identifier: BSD-3-Clause
#include "embree.hpp"

#include <tbb/task_arena.h>

namespace posefusion::simulator {

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

bool blocks(RTCScene scene, const Eigen::Vector3f& a, const Eigen::Vector3f& b, float margin_m) {
  const Eigen::Vector3f d = b - a;
  const float length = d.norm();
  if (length <= 2.0F * margin_m) return false;
  RTCRay ray{};
  ray.org_x = a.x(), ray.org_y = a.y(), ray.org_z = a.z();
  ray.dir_x = d.x(), ray.dir_y = d.y(), ray.dir_z = d.z();
  ray.tnear = margin_m / length;
  ray.tfar = 1.0F - margin_m / length;
  ray.time = 0.5F;
  ray.mask = 0xFFFFFFFFU;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0.0F;
}

}  // namespace posefusion::simulator

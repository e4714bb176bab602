// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/camera_check.hpp"

#include <cmath>
#include <cstdio>

#include "posefusion/core/error.hpp"

namespace pf::simulator {
namespace {

constexpr double kStepS = 0.1;
constexpr float kClearanceM = 0.08F;

/// Why a camera cannot be at `p`; empty when it can.
std::string troubleAt(const Eigen::Vector3f& p, const World& world, const RayCaster& caster) {
  bool inside_room = false;
  for (const auto& room : world.rooms) inside_room |= room.contains(p.cast<double>());
  for (const auto& passage : world.passages) {
    const Eigen::Vector2d d = p.head<2>().cast<double>() - passage.centre;
    inside_room |= d.norm() < 0.8;
  }
  if (!inside_room) return "is outside of all rooms";
  int hits = 0, behind = 0;
  for (int i = 0; i < 26; ++i) {
    const int k = i < 13 ? i : i + 1;
    const Eigen::Vector3f d =
        Eigen::Vector3f(static_cast<float>(k % 3 - 1), static_cast<float>(k / 3 % 3 - 1),
                        static_cast<float>(k / 9 - 1))
            .normalized();
    RTCRayHit ray{};
    ray.ray.org_x = p.x(), ray.ray.org_y = p.y(), ray.ray.org_z = p.z();
    ray.ray.dir_x = d.x(), ray.ray.dir_y = d.y(), ray.ray.dir_z = d.z();
    caster.trace(ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    if (ray.ray.tfar < kClearanceM) return "is closer than 8 cm to a wall or a thing";
    ++hits;
    behind += world.mesh.normals[world.mesh.triangles[ray.hit.primID][0]].dot(d) > 0.0F ? 1 : 0;
  }
  return 2 * behind > hits ? "is inside a wall or a thing" : "";
}

}  // namespace

void checkCamera(const CameraPath& path, const World& world, const RayCaster& caster,
                 double duration_s) {
  for (double t = 0.0; t <= duration_s; t += kStepS) {
    const Eigen::Vector3f p = path.at(t).translation().cast<float>();
    const std::string trouble = troubleAt(p, world, caster);
    if (trouble.empty()) continue;
    char place[96];
    std::snprintf(place, sizeof place, "camera at (%.2f, %.2f, %.2f) m, %.1f s, ", p.x(), p.y(),
                  p.z(), t);
    throw InputError(place + trouble);
  }
}

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
// Light that changes with every frame: on people and things that may move, and in their shadows.
#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "simulator/lighting.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kPacket = 16;
constexpr int kRaysOfPeople = 4;
constexpr float kShadowReach_m = 1.6F;
constexpr float kCells_m = 0.3F;      // over which the light of a vertex fades away
constexpr float kFaint = 0.025F;      // light of a lamp that is not worth its rays
constexpr float kLimbs_m = 0.2F;      // that a body or the camera moves during an exposure
constexpr float kSeenReach_m = 9.0F;  // shadows further away are not worth their rays

/// Calls body(first, count) for packets of [0, total), in parallel.
template <typename Body>
void forPackets(std::size_t total, const Body& body) {
  parallelFor((total + kPacket - 1) / kPacket, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t first = kPacket * begin; first < std::min(kPacket * end, total);
         first += kPacket) {
      body(first, std::min(kPacket, total - first));
    }
  });
}

}  // namespace

bool ViewCone::sees(const Eigen::AlignedBox3f& box) const {
  const Vector3f d = box.center() - eye;
  const float distance = d.norm(), radius = 0.5F * box.sizes().norm() + kLimbs_m;
  if (distance <= radius) return true;
  const float angle = std::acos(std::clamp(axis.dot(d) / distance, -1.0F, 1.0F));
  return angle <= half_angle_rad + std::asin(radius / distance);
}

void Lighting::illuminate(const MoverSurfaces& surfaces, const PosedMovers& movers,
                          const ViewCone& view, FrameLight& light) const {
  const Vector3f& eye = view.eye;
  auto places = surfaces.places;
  float ceiling = 0.0F;
  for (const auto& room : world_.rooms)
    ceiling = std::max(ceiling, static_cast<float>(room.max().z()));
  const auto is_unseen = [&](const Eigen::Vector2f& p) {
    const float reach = kShadowReach_m + kCells_m;
    const Vector3f low(p.x() - reach, p.y() - reach, 0.0F),
        high(p.x() + reach, p.y() + reach, ceiling);
    return (p - eye.head<2>()).norm() > kSeenReach_m || !view.sees({low, high});
  };
  places.erase(std::remove_if(places.begin(), places.end(), is_unseen), places.end());
  castShadows(places, movers, light);
  light.people.resize(surfaces.people.size());
  for (std::size_t i = 0; i < light.people.size(); ++i) {
    const float* openness = movers.avatar(i).openness().data();
    lightBody(surfaces.people[i], openness, movers, view, light.people[i]);
  }
  light.things.resize(surfaces.things.size());
  for (std::size_t i = 0; i < light.things.size(); ++i) {
    lightBody(surfaces.things[i], nullptr, movers, view, light.things[i]);
  }
}

void Lighting::lightBody(const MoverSurfaces::Body& body, const float* openness,
                         const PosedMovers& movers, const ViewCone& view,
                         std::vector<Vector3f>& out) const {
  const Vector3f* positions = body.positions.data();
  const Vector3f* normals = body.normals.data();
  out.resize(body.positions.size());
  Eigen::AlignedBox3f box;
  for (std::size_t v = 0; v < out.size(); ++v) box.extend(positions[v]);
  if (!view.sees(box)) return;
  const auto lamps = lampsFor(box);
  forPackets(out.size(), [&](std::size_t first, std::size_t count) {
    const float* open = openness == nullptr ? nullptr : openness + first;
    light({count, positions + first, normals + first, open, &lamps}, movers, view.eye, &out[first]);
  });
}

std::vector<AreaLight> Lighting::lampsFor(const Eigen::AlignedBox3f& box) const {
  std::vector<AreaLight> lamps;
  for (const AreaLight& lamp : world_.lights) {
    // lampFactor() where both surfaces face each other.
    const float distance = box.exteriorDistance(lamp.centre) - kLimbs_m;
    const float most = 1.274F * lamp.half_u.cross(lamp.half_v).norm() * lamp.radiance.maxCoeff();
    if (distance <= 0.1F || most >= kFaint * distance * distance) lamps.push_back(lamp);
  }
  return lamps;
}

void Lighting::castShadows(const std::vector<Eigen::Vector2f>& places, const PosedMovers& movers,
                           FrameLight& light) const {
  const Mesh& mesh = world_.mesh;
  if (light.world.size() != light_.size()) light.world = light_;
  for (const std::uint32_t v : light.shaded) light.world[v] = light_[v];
  light.shaded.clear();
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Eigen::Vector2f p = mesh.positions[v].head<2>();
    const bool near = std::any_of(places.begin(), places.end(), [&](const auto& place) {
      return (p - place).squaredNorm() <= kShadowReach_m * kShadowReach_m;
    });
    if (near) light.shaded.push_back(v);
  }
  const std::size_t lamps = world_.lights.size();
  forPackets(light.shaded.size(), [&](std::size_t first, std::size_t count) {
    const std::uint32_t* vertices = &light.shaded[first];
    for (std::size_t l = 0; l < lamps; ++l) {
      const auto taken = shadowed(movers, vertices, count, l);
      for (std::size_t i = 0; i < count; ++i) {
        const float part = taken[i] * direct_[vertices[i] * lamps + l];
        light.world[vertices[i]] -= part * world_.lights[l].radiance;
      }
    }
  });
}

std::array<float, 16> Lighting::shadowed(const PosedMovers& movers, const std::uint32_t* vertices,
                                         std::size_t count, std::size_t lamp) const {
  const Mesh& mesh = world_.mesh;
  const AreaLight& area = world_.lights[lamp];
  std::array<float, kPacket> taken{};
  SightPacket sight;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t v = vertices[i];
    const float part = direct_[v * world_.lights.size() + lamp] * area.radiance.maxCoeff();
    sight.asked[i] = part >= 0.05F * light_[v].maxCoeff();
    sight.from[i] = mesh.positions[v] + 4e-3F * mesh.normals[v];
  }
  if (std::find(sight.asked.begin(), sight.asked.end(), true) == sight.asked.end()) return taken;
  for (std::uint32_t ray = 0; ray < kRaysOfPeople; ++ray) {
    for (std::size_t i = 0; i < count; ++i) {
      sight.to[i] = lampPoint(area, ray, hash(vertices[i], 6U));
    }
    const auto blocked = movers.block(sight, 0.01F);
    for (std::size_t i = 0; i < count; ++i) taken[i] += blocked[i] ? 1.0F / kRaysOfPeople : 0.0F;
  }
  return taken;
}

void Lighting::light(const Skin& skin, const PosedMovers& movers, const Vector3f& eye,
                     Vector3f* out) const {
  std::array<bool, kPacket> seen{};
  SightPacket sight;
  std::array<float, kPacket> open;
  for (std::size_t i = 0; i < skin.count; ++i) {
    open[i] = skin.openness == nullptr ? 1.0F : skin.openness[i];
    const Vector3f& p = skin.positions[i];
    const Vector3f& n = skin.normals[i];
    // Well beyond the horizon too: triangles across it are seen. What is skipped must not keep the
    // light of an earlier frame: a slim triangle may show a trace of it at its rim.
    seen[i] = skin.openness == nullptr || n.dot(eye - p) >= -0.6F * (eye - p).norm();
    out[i] = seen[i] ? Vector3f(open[i] * ambient(p, n)) : Vector3f::Zero();
    sight.from[i] = p + 0.012F * n;
  }
  for (const AreaLight& lamp : *skin.lamps) {
    std::array<float, kPacket> factor{};
    for (std::size_t i = 0; i < skin.count; ++i) {
      sight.to[i] = lamp.centre;
      if (seen[i]) factor[i] = lampFactor(lamp, lamp.centre, sight.from[i], skin.normals[i]);
      sight.asked[i] = factor[i] * lamp.radiance.maxCoeff() >= kFaint;
    }
    const auto dark = caster_.blocks(sight, 0.02F);
    for (std::size_t i = 0; i < skin.count; ++i) sight.asked[i] = sight.asked[i] && !dark[i];
    const auto shaded = movers.block(sight, 0.02F);
    for (std::size_t i = 0; i < skin.count; ++i) {
      if (!sight.asked[i]) continue;
      // A lamp is wide: its shadow on the body itself is never black.
      out[i] += factor[i] * (shaded[i] ? 0.25F : 1.0F) * (0.5F + 0.5F * open[i]) * lamp.radiance;
    }
  }
}

Vector3f Lighting::ambient(const Vector3f& position, const Vector3f& normal) const {
  const AmbientCube cube = cubeAt(position);
  Vector3f sum = Vector3f::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = static_cast<std::size_t>(2 * axis + (normal[axis] < 0.0F ? 1 : 0));
    sum += normal[axis] * normal[axis] * cube[side];
  }
  return sum;
}

}  // namespace pf::simulator

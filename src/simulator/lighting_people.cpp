// SPDX-License-Identifier: BSD-3-Clause
// Light that changes with every frame: on people, and in their shadows.
#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "posefusion/simulator/lighting.hpp"
#include "posefusion/simulator/random.hpp"

namespace posefusion::simulator {
namespace {

using Eigen::Vector3f;

constexpr int kShadowRays = 4;
constexpr float kShadowReachM = 1.6F;
constexpr float kSeenReachM = 9.0F;  // shadows further away are not worth their rays

}  // namespace

void Lighting::illuminate(const PosedPeople& people, const Vector3f& eye, FrameLight& light) const {
  castShadows(people, eye, light);
  light.people.resize(people.size());
  for (std::size_t person = 0; person < people.size(); ++person) {
    const auto& positions = people.positions(person);
    const auto& normals = people.normals(person);
    const auto& openness = people.avatar(person).openness();
    auto& out = light.people[person];
    out.resize(positions.size());
    parallelFor(out.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        const Vector3f& p = positions[v];
        const Vector3f& n = normals[v];
        // Well beyond the horizon too: triangles across it are seen. What is skipped must not keep
        // the light of an earlier frame: a slim triangle may show a trace of it at its rim.
        const bool hidden = n.dot(eye - p) < -0.6F * (eye - p).norm();
        out[v] = hidden ? Vector3f::Zero() : at(p, n, openness[v], people);
      }
    });
  }
}

void Lighting::castShadows(const PosedPeople& people, const Vector3f& eye,
                           FrameLight& light) const {
  const Mesh& mesh = world_.mesh;
  if (light.world.size() != light_.size()) light.world = light_;
  for (const std::uint32_t v : light.shaded) light.world[v] = light_[v];
  light.shaded.clear();
  std::vector<Eigen::Vector2f> places = people.places();
  places.erase(
      std::remove_if(places.begin(), places.end(),
                     [&](const auto& p) { return (p - eye.head<2>()).norm() > kSeenReachM; }),
      places.end());
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
    const Eigen::Vector2f p = mesh.positions[v].head<2>();
    const bool near = std::any_of(places.begin(), places.end(), [&](const auto& place) {
      return (p - place).squaredNorm() <= kShadowReachM * kShadowReachM;
    });
    if (near) light.shaded.push_back(v);
  }
  const std::size_t lamps = world_.lights.size();
  parallelFor(light.shaded.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t v = light.shaded[k];
      const Vector3f p = mesh.positions[v] + 4e-3F * mesh.normals[v];
      for (std::size_t l = 0; l < lamps; ++l) {
        const Vector3f part = direct_[v * lamps + l] * world_.lights[l].radiance;
        if (part.maxCoeff() < 0.05F * light_[v].maxCoeff()) continue;
        int blocked = 0;
        for (std::uint32_t i = 0; i < kShadowRays; ++i) {
          const Vector3f q = lampPoint(world_.lights[l], i, hash(v, 6U));
          blocked += people.block(p, q, 0.01F) ? 1 : 0;
        }
        light.world[v] -= part * (static_cast<float>(blocked) / kShadowRays);
      }
    }
  });
}

Vector3f Lighting::at(const Vector3f& position, const Vector3f& normal, float openness,
                      const PosedPeople& people) const {
  const AmbientCube cube = cubeAt(position);
  Vector3f sum = Vector3f::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = static_cast<std::size_t>(2 * axis + (normal[axis] < 0.0F ? 1 : 0));
    sum += normal[axis] * normal[axis] * cube[side];
  }
  sum *= openness;
  const Vector3f p = position + 0.012F * normal;
  for (const AreaLight& lamp : world_.lights) {
    const float factor = lampFactor(lamp, lamp.centre, p, normal);
    if (factor * lamp.radiance.maxCoeff() < 0.025F) continue;
    if (caster_.blocks(p, lamp.centre, 0.02F)) continue;
    const bool shaded = people.block(p, lamp.centre, 0.02F);
    // A lamp is wide: its shadow on the body itself is never black.
    sum += factor * lamp.radiance * (shaded ? 0.25F : 1.0F) * (0.5F + 0.5F * openness);
  }
  return sum;
}

}  // namespace posefusion::simulator

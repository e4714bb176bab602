// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/lighting.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

constexpr int kGatherRays = 64;
constexpr int kShadowRays = 8;
constexpr float kPi = 3.14159265F;

/// Two directions across `n`.
void tangents(const Vector3f& n, Vector3f& a, Vector3f& b) {
  a = (std::abs(n.z()) < 0.9F ? Vector3f::UnitZ() : Vector3f::UnitX()).cross(n).normalized();
  b = n.cross(a);
}

/// The i-th of `count` directions about `n`, as dense as the cosine.
Vector3f cosineDirection(const Vector3f& n, int i, int count, std::uint32_t turn) {
  Vector3f a, b;
  tangents(n, a, b);
  const float r2 = (static_cast<float>(i) + uniform(hash(turn, 1U))) / static_cast<float>(count);
  const float angle = 2.3999632F * static_cast<float>(i) + 6.2831853F * uniform(turn);
  const float r = std::sqrt(r2);
  return r * std::cos(angle) * a + r * std::sin(angle) * b + std::sqrt(1.0F - r2) * n;
}

RTCRayHit rayFrom(const Vector3f& origin, const Vector3f& direction) {
  RTCRayHit ray{};
  ray.ray.org_x = origin.x(), ray.ray.org_y = origin.y(), ray.ray.org_z = origin.z();
  ray.ray.dir_x = direction.x(), ray.ray.dir_y = direction.y(), ray.ray.dir_z = direction.z();
  ray.ray.tnear = 2e-3F;
  return ray;
}

}  // namespace

float lampFactor(const AreaLight& lamp, const Vector3f& on_lamp, const Vector3f& position,
                 const Vector3f& normal) {
  const Vector3f cross = lamp.half_u.cross(lamp.half_v);
  const Vector3f d = on_lamp - position;
  const float squared = std::max(d.squaredNorm(), 0.01F);
  // 4 |cross| is the area; both cosines share one division by the squared distance.
  const float here = normal.dot(d), there = -cross.dot(d) * 4.0F;
  if (here <= 0.0F || there <= 0.0F) return 0.0F;
  return here * there / (squared * squared * kPi);
}

Vector3f lampPoint(const AreaLight& lamp, std::uint32_t i, std::uint32_t turn) {
  // The R2 sequence (Roberts 2018) covers the square evenly for any number of points.
  const float u = static_cast<float>(i) * 0.7548777F + uniform(turn);
  const float v = static_cast<float>(i) * 0.5698403F + uniform(hash(turn, 3U));
  return lamp.centre + (2.0F * (u - std::floor(u)) - 1.0F) * lamp.half_u +
         (2.0F * (v - std::floor(v)) - 1.0F) * lamp.half_v;
}

Lighting::Lighting(const World& world, const RayCaster& caster) : world_(world), caster_(caster) {
  gatherDirect();
  indirect_.assign(world.mesh.positions.size(), Vector3f::Zero());
  light_.resize(indirect_.size());
  for (std::size_t v = 0; v < light_.size(); ++v) shade(v);
  for (int bounce = 0; bounce < 2; ++bounce) gatherIndirect(bounce);
  fillCubes();
}

void Lighting::shade(std::size_t vertex) {
  Vector3f sum = indirect_[vertex];
  for (std::size_t l = 0; l < world_.lights.size(); ++l) {
    sum += direct_[vertex * world_.lights.size() + l] * world_.lights[l].radiance;
  }
  light_[vertex] = sum;
}

void Lighting::gatherDirect() {
  const Mesh& mesh = world_.mesh;
  const std::size_t lamps = world_.lights.size(), count = mesh.positions.size();
  direct_.assign(count * lamps, 0.0F);
  parallelFor((count + 15) / 16, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t packet = begin; packet < end; ++packet) {
      const std::size_t first = 16 * packet, size = std::min<std::size_t>(16, count - first);
      for (std::size_t l = 0; l < lamps; ++l) {
        for (std::uint32_t ray = 0; ray < kShadowRays; ++ray) {
          SightPacket sight;
          std::array<float, 16> factor{};
          for (std::size_t i = 0; i < size; ++i) {
            const std::size_t v = first + i;
            sight.from[i] = mesh.positions[v] + 4e-3F * mesh.normals[v];
            sight.to[i] = lampPoint(world_.lights[l], ray, hash(static_cast<std::uint32_t>(v), 5U));
            factor[i] = lampFactor(world_.lights[l], sight.to[i], sight.from[i], mesh.normals[v]);
            sight.asked[i] = factor[i] > 0.0F;
          }
          const auto blocked = caster_.blocks(sight, 0.02F);
          for (std::size_t i = 0; i < size; ++i) {
            if (!blocked[i]) direct_[(first + i) * lamps + l] += factor[i] / kShadowRays;
          }
        }
      }
    }
  });
}

Vector3f Lighting::reflected(const RTCRayHit& hit) const {
  const Mesh& mesh = world_.mesh;
  const auto& triangle = mesh.triangles[hit.hit.primID];
  const Material& material = world_.materials[mesh.materials[hit.hit.primID]];
  const float u = hit.hit.u, v = hit.hit.v;
  const Vector3f light =
      (1.0F - u - v) * light_[triangle[0]] + u * light_[triangle[1]] + v * light_[triangle[2]];
  const Vector3f& mean = world_.textures[static_cast<std::size_t>(material.texture)].mean();
  // Lamps are counted as direct light; a window's view is both.
  const bool lamp = material.emission.maxCoeff() > 4.0F;
  const Vector3f own =
      lamp ? Vector3f(Vector3f::Zero()) : Vector3f(material.emission.cwiseProduct(mean));
  return light.cwiseProduct(material.tint).cwiseProduct(mean) + own;
}

void Lighting::gatherIndirect(int bounce) {
  const Mesh& mesh = world_.mesh;
  std::vector<Vector3f> gathered(mesh.positions.size());
  parallelFor(mesh.positions.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vector3f p = mesh.positions[v] + 4e-3F * mesh.normals[v];
      const std::uint32_t turn = hash(static_cast<std::uint32_t>(v), 11U + bounce);
      Vector3f sum = Vector3f::Zero();
      for (int i = 0; i < kGatherRays; ++i) {
        RTCRayHit ray = rayFrom(p, cosineDirection(mesh.normals[v], i, kGatherRays, turn));
        caster_.trace(ray);
        if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID) sum += reflected(ray);
      }
      gathered[v] = sum / static_cast<float>(kGatherRays);
    }
  });
  smoothPatches(gathered);
  indirect_ = std::move(gathered);
  for (std::size_t v = 0; v < light_.size(); ++v) shade(v);
}

void Lighting::smoothPatches(std::vector<Vector3f>& light) const {
  std::vector<Vector3f> smooth;
  for (int pass = 0; pass < 2; ++pass) {
    for (const Patch& patch : world_.mesh.patches) {
      smooth.assign(static_cast<std::size_t>(patch.columns * patch.rows), Vector3f::Zero());
      for (int row = 0; row < patch.rows; ++row) {
        for (int col = 0; col < patch.columns; ++col) {
          Vector3f sum = Vector3f::Zero();
          int count = 0;
          for (int r = std::max(0, row - 1); r <= std::min(patch.rows - 1, row + 1); ++r) {
            for (int c = std::max(0, col - 1); c <= std::min(patch.columns - 1, col + 1); ++c) {
              sum += light[patch.first + static_cast<std::uint32_t>(r * patch.columns + c)];
              ++count;
            }
          }
          smooth[static_cast<std::size_t>(row * patch.columns + col)] = sum / count;
        }
      }
      std::copy(smooth.begin(), smooth.end(), light.begin() + patch.first);
    }
  }
}

}  // namespace pf::simulator

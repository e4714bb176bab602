// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/world.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/random.hpp"

namespace pf::simulator {
namespace {

using Eigen::Vector3f;

/// Surfaces that eat or throw away the pattern of the depth camera.
void setInfrared(Material& material, const std::string& kind) {
  if (kind == "screen") material.infrared = 0.10F, material.gloss = 0.55F;
  if (kind == "keys") material.infrared = 0.18F;
  if (kind == "view") material.infrared = 0.02F, material.gloss = 0.9F;
  if (kind == "metal") material.infrared = 0.55F, material.gloss = 0.35F;
  if (kind == "whiteboard") material.infrared = 0.8F, material.gloss = 0.25F;
  if (kind == "tiles") material.infrared = 0.5F, material.gloss = 0.15F;
  if (kind == "screen") material.emission = Vector3f(0.12F, 0.13F, 0.15F);
  if (kind == "view") material.emission = Vector3f(2.6F, 2.8F, 3.1F);
}

cv::Mat plainPicture(const std::string& kind, std::uint32_t seed) {
  std::uint32_t key = seed;
  for (const char letter : kind) key = hash(key, static_cast<std::uint32_t>(letter));
  return cv::Mat(1, 1, CV_8UC3, cv::Scalar::all(between(key, 20.0, 235.0)));
}

int cells(float length_m, float cell_m) {
  return std::clamp(static_cast<int>(std::ceil(length_m / cell_m)), 1, 200);
}

}  // namespace

Placement placed(float x, float y, float z, float yaw) {
  Placement at = Placement::Identity();
  at.translation() = Vector3f(x, y, z);
  at.linear() = Eigen::AngleAxisf(yaw, Vector3f::UnitZ()).toRotationMatrix();
  return at;
}

std::uint16_t World::material(const std::string& kind, std::uint32_t seed, const Vector3f& tint) {
  const auto key = std::make_pair(kind, seed);
  auto it = texture_of_.find(key);
  if (it == texture_of_.end()) {
    it = texture_of_.emplace(key, static_cast<int>(textures.size())).first;
    textures.emplace_back(plain ? plainPicture(kind, seed) : paintTexture(kind, seed));
  }
  Material material;
  material.texture = it->second;
  material.picture_size_m = static_cast<float>(pictureSizeM(kind));
  material.tint = tint;
  const Vector3f mean = textures[static_cast<std::size_t>(it->second)].mean().cwiseProduct(tint);
  material.infrared = 0.25F + 0.6F * mean.maxCoeff();
  material.contrast = textures[static_cast<std::size_t>(it->second)].contrast();
  setInfrared(material, kind);
  materials.push_back(material);
  return static_cast<std::uint16_t>(materials.size() - 1);
}

void addSurface(World& world, const Placement& at, const Covering& covering,
                const SurfaceFunction& surface) {
  Mesh& mesh = world.mesh;
  const Material& material = world.materials[covering.material];
  const int columns = cells(covering.length_s_m, covering.cell_m) + 1;
  const int rows = cells(covering.length_t_m, covering.cell_m) + 1;
  const bool stretched = material.picture_size_m <= 0.0F;
  const float scale_u = stretched ? 1.0F : covering.length_s_m / material.picture_size_m;
  const float scale_v = stretched ? 1.0F : covering.length_t_m / material.picture_size_m;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < columns; ++col) {
      const float s = static_cast<float>(col) / (columns - 1);
      const float t = static_cast<float>(row) / (rows - 1);
      Vector3f position, normal;
      surface(s, t, position, normal);
      mesh.positions.push_back(at * position);
      mesh.normals.push_back(at.linear() * normal);
      // Pictures have their first row on top; t grows upwards.
      mesh.uv.emplace_back(s * scale_u, (1.0F - t) * scale_v);
    }
  }
  for (int row = 0; row + 1 < rows; ++row) {
    for (int col = 0; col + 1 < columns; ++col) {
      const std::uint32_t a = first + static_cast<std::uint32_t>(row * columns + col);
      const std::uint32_t c = a + static_cast<std::uint32_t>(columns);
      mesh.triangles.push_back({a, a + 1, c + 1});
      mesh.triangles.push_back({a, c + 1, c});
      mesh.materials.insert(mesh.materials.end(), 2, covering.material);
    }
  }
  mesh.patches.push_back({first, columns, rows});
}

void addRectangle(World& world, const Placement& at, std::uint16_t material,
                  const std::array<Vector3f, 3>& corner_and_edges, float cell_m) {
  const auto& [corner, s_edge, t_edge] = corner_and_edges;
  const Vector3f normal = s_edge.cross(t_edge).normalized();
  const Covering covering{material, s_edge.norm(), t_edge.norm(), cell_m};
  addSurface(world, at, covering,
             [&, c = corner, e = s_edge, f = t_edge](float s, float t, Vector3f& p, Vector3f& n) {
               p = c + s * e + t * f;
               n = normal;
             });
}

void addBox(World& world, const Placement& at, std::uint16_t material, const Vector3f& centre,
            const Vector3f& size) {
  const Vector3f h = 0.5F * size;
  const Vector3f x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  const auto face = [&](float sx, float sy, float sz, const Vector3f& s, const Vector3f& t) {
    const Vector3f corner = centre + Vector3f(sx * h.x(), sy * h.y(), sz * h.z());
    addRectangle(world, at, material, {corner, s, t}, 0.15F);
  };
  face(-1, -1, -1, x, z);  // front, -y
  face(1, 1, -1, -x, z);   // back, +y
  face(-1, 1, -1, -y, z);  // left, -x
  face(1, -1, -1, y, z);   // right, +x
  face(-1, -1, 1, x, y);   // top
  face(-1, 1, -1, x, -y);  // bottom
}

void addCylinder(World& world, const Placement& at, std::uint16_t material, const Vector3f& foot,
                 const Vector3f& radii_and_height) {
  const float bottom = radii_and_height.x(), top = radii_and_height.y();
  const float height = radii_and_height.z();
  const float around = 6.2831853F * std::max(bottom, top);
  const Covering side{material, around, height, std::max(0.02F, around / 14.0F)};
  addSurface(world, at, side, [&](float s, float t, Vector3f& p, Vector3f& n) {
    const float angle = -6.2831853F * s, radius = bottom + (top - bottom) * t;
    const Vector3f out(std::cos(angle), -std::sin(angle), 0.0F);
    p = foot + radius * out + Vector3f(0, 0, height * t);
    n = (out + Vector3f(0, 0, (bottom - top) / height)).normalized();
  });
  const Covering lid{material, around, top, std::max(0.02F, around / 14.0F)};
  addSurface(world, at, lid, [&](float s, float t, Vector3f& p, Vector3f& n) {
    const float angle = -6.2831853F * s;
    p = foot + (1.0F - t) * top * Vector3f(std::cos(angle), -std::sin(angle), 0.0F) +
        Vector3f(0, 0, height);
    n = Vector3f::UnitZ();
  });
}

}  // namespace pf::simulator

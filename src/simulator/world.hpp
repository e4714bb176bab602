// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "simulator/texture.hpp"

namespace pf::simulator {

/// How a surface looks to the colour camera and to the infrared of the depth camera.
struct Material {
  int texture = 0;
  float picture_size_m = 1.0F;  ///< 0: stretched over the face
  Eigen::Vector3f tint = Eigen::Vector3f::Ones();
  Eigen::Vector3f emission = Eigen::Vector3f::Zero();  ///< radiance
  float infrared = 0.6F;                               ///< reflectance of the projected pattern
  float contrast = 0.0F;                               ///< of the texture
  float gloss = 0.0F;  ///< 0 matt, 1 mirror-like: no depth where the pattern is reflected away
};

/// A rectangular grid of vertices: neighbours on a surface, for smoothing the light.
struct Patch {
  std::uint32_t first = 0;
  int columns = 0;
  int rows = 0;
};

/// Triangles with light at their vertices. World frame: metres, z up.
struct Mesh {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2f> uv;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint16_t> materials;  ///< per triangle
  std::vector<Patch> patches;
};

/// A rectangle that sends light from its front: centre, half edges (their cross product is the
/// direction of the light), radiance.
struct AreaLight {
  Eigen::Vector3f centre;
  Eigen::Vector3f half_u;
  Eigen::Vector3f half_v;
  Eigen::Vector3f radiance;
};

/// What stands on the floor, seen from above: people walk around it, cameras stay out of it.
struct Footprint {
  Eigen::Vector2d centre;
  Eigen::Vector2d half_size;
  double yaw = 0.0;
};

/// Everything that does not move.
struct World {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  Mesh mesh;
  std::vector<AreaLight> lights;
  std::vector<Footprint> footprints;
  std::vector<Footprint> passages;  ///< floor of doorways
  std::vector<Eigen::AlignedBox3d> rooms;
  /// Pictures are not painted but of one random grey each: for depth alone, a thousand times
  /// faster.
  bool plain = false;

  /// The material of a texture kind, painted once for each (kind, seed), tinted.
  std::uint16_t material(const std::string& kind, std::uint32_t seed,
                         const Eigen::Vector3f& tint = Eigen::Vector3f::Ones());

 private:
  std::map<std::pair<std::string, std::uint32_t>, int> texture_of_;
};

/// A piece of furniture's own frame within the world.
using Placement = Eigen::Isometry3f;

/// Placement at (x, y, z) metres, turned by yaw (rad) about the vertical.
Placement placed(float x, float y, float z, float yaw = 0.0F);

/// A surface by its parameters s, t in [0, 1]: position and normal in the placement's frame.
using SurfaceFunction =
    std::function<void(float s, float t, Eigen::Vector3f& position, Eigen::Vector3f& normal)>;

/// How a surface is covered: its size along s and t for the texture, and the length of its cells.
struct Covering {
  std::uint16_t material = 0;
  float length_s_m = 1.0F;
  float length_t_m = 1.0F;
  float cell_m = 0.12F;
};

void addSurface(World& world, const Placement& at, const Covering& covering,
                const SurfaceFunction& surface);

/// Flat rectangle from `corner` along the two edges; its front is edge_s x edge_t.
void addRectangle(World& world, const Placement& at, std::uint16_t material,
                  const std::array<Eigen::Vector3f, 3>& corner_and_edges, float cell_m = 0.12F);

/// Box with the given centre and size.
void addBox(World& world, const Placement& at, std::uint16_t material,
            const Eigen::Vector3f& centre, const Eigen::Vector3f& size);

/// Upright cylinder (or cone: two radii) on `foot`, closed at the top.
void addCylinder(World& world, const Placement& at, std::uint16_t material,
                 const Eigen::Vector3f& foot, const Eigen::Vector3f& radii_and_height);

}  // namespace pf::simulator

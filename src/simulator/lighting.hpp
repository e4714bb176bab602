// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "simulator/posed_movers.hpp"
#include "simulator/raycaster.hpp"
#include "simulator/world.hpp"

namespace pf::simulator {

/// Light that comes in at a point of the air from the six directions +x -x +y -y +z -z, as the
/// radiance of a white surface that faces there, lamps left out.
using AmbientCube = std::array<Eigen::Vector3f, 6>;

/// The surfaces of all that moves at one moment, world.
struct MoverSurfaces {
  /// A person's or a thing's vertices.
  struct Body {
    std::vector<Eigen::Vector3f> positions, normals;
  };
  std::vector<Body> people, things;
  std::vector<Eigen::Vector2f> places;  ///< where they stand
};

/// Light on white surfaces at all vertices during one frame, as radiance.
struct FrameLight {
  std::vector<Eigen::Vector3f> world;                ///< [vertex], with the people's shadows
  std::vector<std::vector<Eigen::Vector3f>> people;  ///< [person][vertex]
  std::vector<std::vector<Eigen::Vector3f>> things;  ///< [thing][vertex]
  std::vector<std::uint32_t> shaded;                 ///< vertices of the world near movers
};

/// What a camera may see: all within an angle about its axis.
struct ViewCone {
  Eigen::Vector3f eye, axis;
  float half_angle_rad;

  bool sees(const Eigen::AlignedBox3f& box) const;
};

/// Light at the vertices of the static world: direct light of each lamp with soft shadows, and
/// what the surfaces throw at each other (radiosity gathered with rays, two bounces). Worked out
/// once, when it is made; from then on thread safe. People and things that may move take light away
/// from the vertices near them, frame by frame.
class Lighting {
 public:
  Lighting(const World& world, const RayCaster& caster);

  /// Light of a frame seen from `view` (world, metres): on people and things where they may be seen
  /// from there, and on the world with the shadows of those near. `movers` cast them. `light` may
  /// be that of another frame.
  void illuminate(const MoverSurfaces& surfaces, const PosedMovers& movers, const ViewCone& view,
                  FrameLight& light) const;

 private:
  void castShadows(const std::vector<Eigen::Vector2f>& places, const PosedMovers& movers,
                   FrameLight& light) const;
  /// The share of a lamp's light that movers take from up to 16 vertices of the world.
  std::array<float, 16> shadowed(const PosedMovers& movers, const std::uint32_t* vertices,
                                 std::size_t count, std::size_t lamp) const;
  /// Light on a body that `view` may see. `openness` of its vertices; none: open all over.
  void lightBody(const MoverSurfaces::Body& body, const float* openness, const PosedMovers& movers,
                 const ViewCone& view, std::vector<Eigen::Vector3f>& out) const;
  /// Light on up to 16 points of a body: lamps with shadows, then the rest by the nearest cubes.
  struct Skin {
    std::size_t count = 0;
    const Eigen::Vector3f* positions = nullptr;
    const Eigen::Vector3f* normals = nullptr;
    const float* openness = nullptr;                ///< none: a thing, open and seen all over
    const std::vector<AreaLight>* lamps = nullptr;  ///< that may light them
  };
  /// Those whose light on a body within the box is worth a ray.
  std::vector<AreaLight> lampsFor(const Eigen::AlignedBox3f& box) const;
  void light(const Skin& skin, const PosedMovers& movers, const Eigen::Vector3f& eye,
             Eigen::Vector3f* out) const;
  Eigen::Vector3f ambient(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const;
  void gatherDirect();
  void gatherIndirect(int bounce);
  void smoothPatches(std::vector<Eigen::Vector3f>& light) const;
  void fillCubes();
  AmbientCube cubeAt(const Eigen::Vector3f& position) const;
  Eigen::Vector3f reflected(const RTCRayHit& hit) const;
  void shade(std::size_t vertex);

  const World& world_;
  const RayCaster& caster_;
  std::vector<float> direct_;  ///< [vertex][lamp], radiance of a white surface for a unit lamp
  std::vector<Eigen::Vector3f> indirect_;
  std::vector<Eigen::Vector3f> light_;  ///< at the vertices, without people
  Eigen::Vector3f cubes_from_ = Eigen::Vector3f::Zero();
  Eigen::Vector3i cubes_ = Eigen::Vector3i::Zero();
  std::vector<AmbientCube> cube_;
};

/// Radiance of a white surface at `position` facing `normal` lit by a unit lamp, shadows left out.
float lampFactor(const AreaLight& lamp, const Eigen::Vector3f& on_lamp,
                 const Eigen::Vector3f& position, const Eigen::Vector3f& normal);

/// The i-th of 16 points spread over a lamp, turned by `turn`.
Eigen::Vector3f lampPoint(const AreaLight& lamp, std::uint32_t i, std::uint32_t turn);

}  // namespace pf::simulator

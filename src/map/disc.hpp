// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "projection.hpp"

namespace pf {

/// A surfel in the camera frame, with the pixels that its disc may cover.
struct Disc {
  float x, y, z, nx, ny, nz;
  float offset;           ///< n . (x, y, z): the disc's plane
  float inverse_radius2;  ///< 1 / radius^2
  std::int16_t first_u, last_u, first_v, last_v;
  float intensity, odds;
  std::uint32_t slot;  ///< of its surfel in its block
  bool stable;
};

/// Where a ray meets a disc.
struct Hit {
  float depth;     ///< along the optical axis
  float distance;  ///< from the disc's centre, as part of its radius, squared
  int is_hit;      ///< 0 where the ray misses: the others then mean nothing
};

/// The ray is (ray_x, ray_y, 1). Without branches, so that it can become SIMD code.
inline Hit intersect(const Disc& d, float ray_x, float ray_y) {
  // A disc seen under a flatter angle than this is drawn as if it faced the camera: the plane
  // intersection is of no use there.
  constexpr float kMinCosine = 0.15F;
  const float cosine = d.nx * ray_x + d.ny * ray_y + d.nz;  // times the length of the ray
  const float least = kMinCosine * kMinCosine * (ray_x * ray_x + ray_y * ray_y + 1);
  const float depth = cosine * cosine < least ? d.z : d.offset / cosine;
  const float dx = ray_x * depth - d.x, dy = ray_y * depth - d.y, dz = depth - d.z;
  const float distance = (dx * dx + dy * dy + dz * dz) * d.inverse_radius2;
  return {depth, distance, static_cast<int>(distance <= 1.0F) & static_cast<int>(depth >= kNear_m)};
}

/// The rays through the pixels of a camera.
struct Rays {
  explicit Rays(const PinholeCamera& c)
      : cx(static_cast<float>(c.cx)),
        cy(static_cast<float>(c.cy)),
        inverse_fx(1.0F / static_cast<float>(c.fx)),
        inverse_fy(1.0F / static_cast<float>(c.fy)),
        width(c.width),
        height(c.height) {}

  float x(int u) const { return (static_cast<float>(u) - cx) * inverse_fx; }
  float y(int v) const { return (static_cast<float>(v) - cy) * inverse_fy; }

  float cx, cy, inverse_fx, inverse_fy;
  int width, height;
};

/// A pixel whose ray meets a disc.
struct PixelHit {
  std::int32_t pixel;  ///< v * width + u
  std::uint32_t disc;  ///< its place among those splatted
  float depth, distance;
};

/// Rays that `splat` tries at most.
inline std::size_t raysAt(const Disc& d) {
  return static_cast<std::size_t>(d.last_u - d.first_u + 1) * (d.last_v - d.first_v + 1);
}

/// Finds the pixels whose rays meet the discs; returns their number. `hits` has room for
/// raysAt() of all discs, and one more.
std::size_t splat(const Disc* discs, std::size_t count, const Rays& rays, PixelHit* hits);

}  // namespace pf

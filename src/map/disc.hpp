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
  std::uint32_t slot;  ///< of its surfel in its block
  bool stable;
};

/// Where a ray meets a disc.
struct Hit {
  float depth = 0;     ///< along the optical axis; 0 when the ray misses
  float distance = 0;  ///< from the disc's centre, as part of its radius, squared
};

/// The ray is (ray_x, ray_y, 1).
inline Hit intersect(const Disc& d, float ray_x, float ray_y) {
  // A disc seen under a flatter angle than this is drawn as if it faced the camera: the plane
  // intersection is of no use there.
  constexpr float kMinCosine = 0.15F;
  const float cosine = d.nx * ray_x + d.ny * ray_y + d.nz;  // times the length of the ray
  const bool steep =
      cosine * cosine < kMinCosine * kMinCosine * (ray_x * ray_x + ray_y * ray_y + 1);
  const float depth = steep ? d.z : d.offset / cosine;
  const float dx = ray_x * depth - d.x, dy = ray_y * depth - d.y, dz = depth - d.z;
  const float distance = (dx * dx + dy * dy + dz * dz) * d.inverse_radius2;
  if (distance > 1.0F || depth < kNear_m) return {};
  return {depth, distance};
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

/// Calls found(pixel, hit) for each pixel whose ray meets the disc.
template <typename Found>
void splat(const Disc& d, const Rays& rays, const Found& found) {
  for (int v = d.first_v; v <= d.last_v; ++v) {
    const float ray_y = rays.y(v);
    for (int u = d.first_u; u <= d.last_u; ++u) {
      const Hit hit = intersect(d, rays.x(u), ray_y);
      if (hit.depth > 0) found(v * rays.width + u, hit);
    }
  }
}

}  // namespace pf

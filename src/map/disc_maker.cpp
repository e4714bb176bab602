// SPDX-License-Identifier: BSD-3-Clause
#include "disc_maker.hpp"

#include <algorithm>

#include "pixel_box.hpp"

namespace pf {
namespace {

constexpr float kMaxSplatRadius_px = 12.0F;

}  // namespace

std::uint32_t DiscMaker::make(const SurfelRange& range, Disc* discs) const {
  const SurfelArrays& s = map_.blocks()[range.block].surfels;
  ProjectedRange seen;
  project(s, range, projection_, seen);
  std::uint32_t count = 0;
  for (std::uint32_t k = 0; k < range.end - range.begin; ++k) {
    // A disc that shows its back is not drawn.
    if (seen.inside[k] == 0 || seen.facing[k] > 0) continue;
    const std::uint32_t i = range.begin + k;
    const bool stable = map_.isStable(s, i);
    if ((!stable && options_.only_stable) || map_.isDead(s, i)) continue;
    if (options_.age != SurfelAge::all &&
        map_.isActive(s, i) != (options_.age == SurfelAge::active)) {
      continue;
    }
    Disc& d = discs[count];
    if (!cover(seen, k, d)) continue;
    d.x = seen.x[k];
    d.y = seen.y[k];
    d.z = seen.z[k];
    to_camera_.direction(s.nx[i], s.ny[i], s.nz[i], d.nx, d.ny, d.nz);
    d.offset = seen.facing[k];
    d.inverse_radius2 = 1.0F / (s.radius[i] * s.radius[i]);
    d.intensity = 0.299F * s.r[i] + 0.587F * s.g[i] + 0.114F * s.b[i];
    d.odds = s.odds[i];
    d.slot = i;
    d.stable = stable;
    ++count;
  }
  return count;
}

bool DiscMaker::cover(const ProjectedRange& seen, std::uint32_t k, Disc& d) const {
  const float reach = std::min(seen.reach[k], kMaxSplatRadius_px);
  const PixelBox box = pixelsWithin(seen.u[k], seen.v[k], reach, rays_.width, rays_.height);
  if (box.isEmpty()) return false;
  d.first_u = static_cast<std::int16_t>(box.first_u);
  d.last_u = static_cast<std::int16_t>(box.last_u);
  d.first_v = static_cast<std::int16_t>(box.first_v);
  d.last_v = static_cast<std::int16_t>(box.last_v);
  return true;
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "disc_maker.hpp"

#include <algorithm>

namespace pf {
namespace {

constexpr float kMaxSplatRadius_px = 12.0F;
constexpr float kAlmostOne = 0.9999F;  // int(x + kAlmostOne) rounds x up

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
  const float u = seen.u[k], v = seen.v[k];
  // Casts cut towards zero: rounding down, since nothing below zero is left after max().
  const float left = std::max(0.0F, u - reach) + kAlmostOne, right = u + reach;
  const float top = std::max(0.0F, v - reach) + kAlmostOne, bottom = v + reach;
  if (!(right >= 0 && bottom >= 0 && left < static_cast<float>(rays_.width) &&
        top < static_cast<float>(rays_.height))) {
    return false;
  }
  d.first_u = static_cast<std::int16_t>(left);
  d.first_v = static_cast<std::int16_t>(top);
  d.last_u = static_cast<std::int16_t>(std::min(right, static_cast<float>(rays_.width - 1)));
  d.last_v = static_cast<std::int16_t>(std::min(bottom, static_cast<float>(rays_.height - 1)));
  return d.first_u <= d.last_u && d.first_v <= d.last_v;
}

}  // namespace pf

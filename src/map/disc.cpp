// SPDX-License-Identifier: BSD-3-Clause
#include "disc.hpp"

#include <algorithm>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr int kLanes = 16;
constexpr int kShift = 16;  // of a reciprocal in whole numbers

}  // namespace

POSEFUSION_SIMD_CLONES
std::size_t splat(const Disc* discs, std::size_t count, const Rays& rays, PixelHit* hits) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Disc d = discs[i];
    const int width = d.last_u - d.first_u + 1, area = static_cast<int>(raysAt(d));
    const int inverse_width = (1 << kShift) / width + 1;
    for (int begin = 0; begin < area; begin += kLanes) {
      float depth[kLanes], distance[kLanes];
      int pixel[kLanes], is_hit[kLanes];
      for (int l = 0; l < kLanes; ++l) {
        const int row = ((begin + l) * inverse_width) >> kShift;
        const int u = d.first_u + begin + l - row * width, v = d.first_v + row;
        const Hit hit = intersect(d, rays.x(u), rays.y(v));
        depth[l] = hit.depth;
        distance[l] = hit.distance;
        is_hit[l] = hit.is_hit;
        pixel[l] = v * rays.width + u;
      }
      const int lanes = std::min(kLanes, area - begin);
      for (int l = 0; l < lanes; ++l) {
        hits[found] = {pixel[l], static_cast<std::uint32_t>(i), depth[l], distance[l]};
        found += static_cast<std::size_t>(is_hit[l]);
      }
    }
  }
  return found;
}

}  // namespace pf

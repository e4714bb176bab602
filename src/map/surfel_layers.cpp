// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that were mapped twice, a little apart: what stands beside an older layer is
// contradicted.
#include <algorithm>
#include <cmath>

#include "posefusion/map/layers.hpp"
#include "surfel_update.hpp"

namespace pf {
namespace {

// Layers of one surface are parallel, and so many tolerances apart at most.
constexpr float kLayerTolerances = 3.0F;
constexpr float kParallelCosine = 0.9F;

}  // namespace

bool SurfelUpdate::isLayer(const Place& p, float measured, float cosine) const {
  return p.facing < 0 && cosine > kParallelCosine &&
         std::abs(measured - p.z) <= kLayerTolerances * agreement(p.z);
}

SurfelUpdate::Supported SurfelUpdate::supportedAt(const SurfelArrays& s, const Place& p) const {
  const float cosine = p.facing / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  return {p.surfel, static_cast<std::uint32_t>(p.level->at(p.level_u, p.level_v)), p.z,
          std::abs(cosine), std::max(s.radius[p.surfel], p.z / p.level->fx)};
}

void SurfelUpdate::contradict(const Result& result, SurfelArrays& s) const {
  for (const Layer& layer : result.layers) {
    const std::int64_t explanation = evidence_.explained[layer.pixel];
    if (Explanation::made(explanation) < s.created[layer.surfel]) contradictOne(s, layer.surfel);
  }
  for (const Supported& seen : result.supported) {
    const std::size_t i = seen.surfel;
    const bool stable = map_.isStable(s, i);
    if (stable && !options_.may_remove_stable) continue;
    if (!isDoubled(seen, s.created[i] - (stable ? another_pass_ : 1))) continue;
    // Its support is taken back, and as much of that before.
    contradictOne(s, i, 2.0F * static_cast<float>(stable ? kTurns : 1));
  }
}

/// Whether a stable surfel made in frame `before` or earlier agrees with the same measurement, and
/// is so far from this one along its normal that the two are no one surface.
bool SurfelUpdate::isDoubled(const Supported& seen, std::int32_t before) const {
  const std::int64_t older = evidence_.explained[seen.pixel];
  if (Explanation::made(older) > before) return false;
  const float sine = std::sqrt(std::max(0.0F, 1.0F - seen.cosine * seen.cosine));
  const float apart = std::abs(Explanation::depth(older) - seen.z) * seen.cosine;
  return apart > kLeastLayer_m + seen.beside_m * sine;
}

}  // namespace pf

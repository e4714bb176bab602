// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/view_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/calibration/pair_residual.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr std::size_t kSamples = 150;  // patches of a view that are looked for in another
constexpr double kFarthest_m = 6.0;    // between cameras: more than any depth used
constexpr double kLeastFacing = 0.5;   // cosine between optical axes: 60 degrees, a field of view

bool maySeeTheSame(const ViewSurface& a, const ViewSurface& b) {
  const Eigen::Isometry3d &T_a = a.T_map_camera(), &T_b = b.T_map_camera();
  return a.fragment() == b.fragment() &&
         (T_a.translation() - T_b.translation()).norm() < kFarthest_m &&
         T_a.linear().col(2).dot(T_b.linear().col(2)) > kLeastFacing;
}

double overlapOf(const ViewSurface& from, const ViewSurface& to, const PairLimits& limits) {
  const auto& patches = from.patches();
  if (patches.empty() || to.patches().empty()) return 0;
  const Eigen::Isometry3d T_to_from = to.T_map_camera().inverse() * from.T_map_camera();
  const std::size_t stride = std::max<std::size_t>(1, patches.size() / kSamples);
  const DepthField none(4, 4);
  std::size_t tried = 0, met = 0;
  for (std::size_t i = 0; i < patches.size(); i += stride) {
    ++tried;
    const auto r = pairResidual(patches[i], from, to, T_to_from, none);
    if (r && std::abs(r->e) * r->metres < limits.most_apart_m) ++met;
  }
  return static_cast<double>(met) / static_cast<double>(tried);
}

/// Appends at most so many, evenly spread over all.
void addSpread(const std::vector<ViewPair>& all, std::size_t most, std::vector<ViewPair>& out) {
  const std::size_t count = std::min(all.size(), most);
  for (std::size_t k = 0; k < count; ++k) out.push_back(all[k * all.size() / count]);
}

}  // namespace

std::vector<ViewPair> overlappingPairs(const std::vector<ViewSurface>& surfaces,
                                       const PairLimits& limits) {
  std::vector<std::vector<ViewPair>> of_view(surfaces.size());
  parallelFor(surfaces.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t j = i + 1; j < surfaces.size(); ++j) {
        if (!maySeeTheSame(surfaces[i], surfaces[j])) continue;
        const double overlap = std::min(overlapOf(surfaces[i], surfaces[j], limits),
                                        overlapOf(surfaces[j], surfaces[i], limits));
        if (overlap < limits.least_overlap) continue;
        of_view[i].push_back(
            {i, j, surfaces[j].T_map_camera().inverse() * surfaces[i].T_map_camera(), overlap});
      }
    }
  });
  std::vector<ViewPair> pairs;
  for (const auto& found : of_view) addSpread(found, limits.most_per_view, pairs);
  if (pairs.size() <= limits.most_pairs) return pairs;
  std::vector<ViewPair> fewer;
  addSpread(pairs, limits.most_pairs, fewer);
  return fewer;
}

}  // namespace pf

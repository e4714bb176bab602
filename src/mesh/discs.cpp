// SPDX-License-Identifier: BSD-3-Clause
#include "discs.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

// A cell that the surface crosses has all its corners so near to it, in cells: its diagonal.
constexpr float kDiagonal = 1.7321F;
constexpr float kDepth = 2.0F;  // cells
// Of a surfel that was seen from very far or aslant no more counts, in bridges: it must not cover
// unobserved space.
constexpr float kMostRadius = 0.4F;

}  // namespace

DiscMaker::DiscMaker(const SurfelArrays& surfels, const MeshConfig& config)
    : surfels_(surfels),
      cell_m_(static_cast<float>(config.cell_m)),
      bridge_m_(static_cast<float>(config.bridge_m)),
      depth_m_(kDepth * cell_m_) {}

float DiscMaker::farthest(const MeshConfig& config) {
  const auto cell_m = static_cast<float>(config.cell_m),
             bridge_m = static_cast<float>(config.bridge_m);
  return std::hypot(kMostRadius * bridge_m + std::max(bridge_m, kDiagonal * cell_m),
                    kDepth * cell_m);
}

bool DiscMaker::make(std::size_t i, Disc& disc) const {
  const SurfelArrays& s = surfels_;
  disc.center = {s.x[i], s.y[i], s.z[i]};
  disc.normal = {s.nx[i], s.ny[i], s.nz[i]};
  const float length = disc.normal.norm(), radius = s.radius[i];
  if (!disc.center.allFinite() || !(length > 0.5F && length < 2.0F) || !(radius > 0)) return false;
  disc.normal /= length;
  disc.radius = std::min(radius, kMostRadius * bridge_m_);
  disc.reach = disc.radius + std::max(bridge_m_, kDiagonal * cell_m_);
  disc.depth = depth_m_;
  disc.weight = std::isfinite(s.weight[i]) ? std::max(0.1F, s.weight[i]) : 0.1F;
  disc.color = {s.r[i], s.g[i], s.b[i]};
  return true;
}

bool DiscMaker::cells(const Disc& disc, CellRange& range) const {
  const float farthest = static_cast<float>(BlockLattice::kFarthestBlock - 1) *
                         static_cast<float>(BlockLattice::kSide) * cell_m_;
  if (disc.center.cwiseAbs().maxCoeff() + disc.reach + disc.depth > farthest) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const float n = disc.normal[axis];
    const float half = disc.depth * std::abs(n) + disc.reach * std::sqrt(std::max(0.0F, 1 - n * n));
    range.low[axis] = static_cast<int>(std::ceil((disc.center[axis] - half) / cell_m_)) - 1;
    range.high[axis] = static_cast<int>(std::floor((disc.center[axis] + half) / cell_m_));
  }
  return true;
}

}  // namespace pf

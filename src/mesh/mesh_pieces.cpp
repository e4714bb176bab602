// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/mesh/mesh_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "discs.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"

namespace pf {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Vector3f;

constexpr float kLeastSide_cells = 4;
// From the centre of a triangle to the corners of the cells that determine its vertices, and of
// those beside it, whose triangles determine the normals.
constexpr float kStencil_cells = 4;

float reachOf(const MeshConfig& config) {
  const auto cell_m = static_cast<float>(config.cell_m);
  return DiscMaker::farthest(config) + kStencil_cells * cell_m;
}

/// Of the surfels of a block that a mesh is made of.
bool isOfTheMesh(const SurfelBlock& block) {
  return block.fragment == kFirstFragment && block.surfels.size() > 0;
}

}  // namespace

MeshPieces::MeshPieces(const MeshConfig& config, float side_m)
    : config_(config), side_m_(side_m), reach_m_(reachOf(config)) {
  validate(config);
  require(side_m >= kLeastSide_cells * config.cell_m, "mesh: side of a piece:", side_m,
          "at least four cells");
}

void MeshPieces::forget() {
  before_.clear();
  doubtful_.clear();
  shown_.clear();
}

AlignedBox3f MeshPieces::boxOf(const Key& key) const {
  const Vector3f low = side_m_ * Vector3f(static_cast<float>(key[0]), static_cast<float>(key[1]),
                                          static_cast<float>(key[2]));
  return {low, low + Vector3f::Constant(side_m_)};
}

void MeshPieces::mark(const SurfelBlock& block) {
  if (!isOfTheMesh(block) || block.bounds.isEmpty()) return;
  const auto number = [&](float m) { return static_cast<int>(std::floor(m / side_m_)); };
  Key low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    low[axis] = number(block.bounds.min()[i] - reach_m_);
    high[axis] = number(block.bounds.max()[i] + reach_m_);
  }
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) doubtful_.insert({x, y, z});
    }
  }
}

/// Where something is, and where something was.
void MeshPieces::markChanges(const SharedBlocks& blocks) {
  for (std::size_t i = 0; i < std::max(blocks.size(), before_.size()); ++i) {
    if (blocks.isShared(i, before_)) continue;
    if (i < blocks.size()) mark(blocks[i]);
    if (i < before_.size()) mark(before_[i]);
  }
}

SurfelArrays MeshPieces::surfelsAround(const SurfelMap& map, const Key& key) const {
  AlignedBox3f box = boxOf(key);
  box.min().array() -= reach_m_;
  box.max().array() += reach_m_;
  SurfelArrays around;
  std::vector<std::uint32_t> found;
  for (const SurfelBlock& block : map.blocks()) {
    if (!isOfTheMesh(block) || !box.intersects(block.bounds)) continue;
    const SurfelArrays& s = block.surfels;
    found.clear();
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (map.isStable(s, i) && box.contains(Vector3f(s.x[i], s.y[i], s.z[i]))) {
        found.push_back(static_cast<std::uint32_t>(i));
      }
    }
    around.append(s, found.data(), found.size());
  }
  return around;
}

TriangleMesh MeshPieces::make(const SurfelMap& map, const Key& key) const {
  const TriangleMesh mesh = surfelMeshIfAny(surfelsAround(map, key), config_);
  const auto number = [&](float m) { return static_cast<int>(std::floor(m / side_m_)); };
  std::vector<char> keep(mesh.triangles.size());
  for (std::size_t i = 0; i < keep.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Vector3f center =
        (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
    const Key of{number(center.x()), number(center.y()), number(center.z())};
    keep[i] = of == key ? 1 : 0;
  }
  return onlyKept(mesh, keep);
}

std::vector<MeshPieces::Piece> MeshPieces::update(const SurfelMap& map,
                                                  const std::function<bool()>& stops) {
  markChanges(map.blocks());
  before_ = map.blocks();
  std::vector<Piece> changed;
  while (!doubtful_.empty() && !(stops && stops())) {
    const Key key = *doubtful_.begin();
    Piece piece{key, make(map, key)};
    doubtful_.erase(doubtful_.begin());
    const bool is_empty = piece.mesh.triangles.empty();
    const bool was_shown = shown_.count(key) > 0;
    if (is_empty && !was_shown) continue;
    if (is_empty) {
      shown_.erase(key);
    } else {
      shown_.insert(key);
    }
    changed.push_back(std::move(piece));
  }
  return changed;
}

}  // namespace pf

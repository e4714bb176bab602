// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/mesh/surface_nets.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr int kSide = BlockLattice::kSide, kPatch = kSide + 1;
constexpr std::size_t kNetBlocksAtOnce = 8;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

enum class Layer { after, before };

/// What is known of a block's corners or cells and of a layer of those of its neighbours, after it
/// or before it.
template <typename T>
class Patch {
 public:
  /// `read(i, place)`: that of block i.
  template <typename Read>
  Patch(const BlockLattice& lattice, std::size_t i, Layer layer, T nothing, const Read& read) {
    const int side = layer == Layer::after ? 1 : -1;
    std::array<std::size_t, 8> source{};
    for (int n = 0; n < 8; ++n) {
      const Vector3i step(n & 1, n >> 1 & 1, n >> 2);
      source[static_cast<std::size_t>(n)] =
          n == 0 ? i : lattice.find(lattice.block(i) + side * step);
    }
    const int first = layer == Layer::after ? 0 : -1;
    T* out = values_.data();
    for (int z = first; z < first + kPatch; ++z) {
      for (int y = first; y < first + kPatch; ++y) {
        for (int x = first; x < first + kPatch; ++x, ++out) {
          const auto n = static_cast<std::size_t>(beyond(x) | beyond(y) << 1 | beyond(z) << 2);
          *out = source[n] == BlockLattice::kNone ? nothing : read(source[n], placeOf(x, y, z));
        }
      }
    }
    origin_ = -first * (1 + kPatch + kPatch * kPatch);
  }

  T at(const Vector3i& p) const {
    return values_[static_cast<std::size_t>(origin_ + p.x() + kPatch * (p.y() + kPatch * p.z()))];
  }

 private:
  static int beyond(int k) { return k < 0 || k >= kSide ? 1 : 0; }
  static std::size_t placeOf(int x, int y, int z) {
    return BlockLattice::placeOf((x + kSide) % kSide, (y + kSide) % kSide, (z + kSide) % kSide);
  }

  std::array<T, kPatch * kPatch * kPatch> values_;
  int origin_ = 0;
};

using Distances = Patch<float>;
using Vertices = Patch<std::uint32_t>;

Distances distancesOf(const DistanceField& field, std::size_t i) {
  return {field.lattice, i, Layer::after, kUnknown, [&](std::size_t block, std::size_t place) {
            return field.values[block * BlockLattice::kCorners + place];
          }};
}

template <typename Visit>
void forEachPlace(const Visit& visit) {
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) visit(Vector3i(x, y, z));
    }
  }
}

/// The mean of the crossings of a cell's edges, in cells from its first corner. False where there
/// are none, or where a corner is not known.
bool crossing(const Distances& distances, const Vector3i& cell, Vector3f& point) {
  std::array<float, 8> corner{};
  int inside = 0;
  for (int i = 0; i < 8; ++i) {
    const float d = distances.at(cell + Vector3i(i & 1, i >> 1 & 1, i >> 2));
    if (std::isnan(d)) return false;
    corner[static_cast<std::size_t>(i)] = d;
    inside += d < 0.0F ? 1 : 0;
  }
  if (inside == 0 || inside == 8) return false;
  Vector3f sum = Vector3f::Zero();
  int count = 0;
  for (int i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const int j = i | 1 << axis;
      const float from = corner[static_cast<std::size_t>(i)];
      const float to = corner[static_cast<std::size_t>(j)];
      if (j == i || (from < 0.0F) == (to < 0.0F)) continue;
      Vector3f p = Vector3i(i & 1, i >> 1 & 1, i >> 2).cast<float>();
      p[axis] = from / (from - to);
      sum += p;
      ++count;
    }
  }
  point = sum / static_cast<float>(count);
  return true;
}

/// The vertices of block i, numbered from 0 in it.
std::vector<Vector3f> verticesOf(const DistanceField& field, std::size_t i, std::uint16_t* place) {
  const Distances distances = distancesOf(field, i);
  const Vector3i first = field.lattice.firstCorner(i);
  std::vector<Vector3f> points;
  forEachPlace([&](const Vector3i& cell) {
    Vector3f point;
    if (!crossing(distances, cell, point)) return;
    place[BlockLattice::placeOf(cell.x(), cell.y(), cell.z())] =
        static_cast<std::uint16_t>(points.size());
    points.push_back(field.lattice.point(first + cell) + field.lattice.cell_m() * point);
  });
  return points;
}

/// Two triangles across each edge of block i that crosses the surface.
std::vector<std::array<std::uint32_t, 3>> trianglesOf(const DistanceField& field, std::size_t i,
                                                      const SurfaceNet& net) {
  const Distances distances = distancesOf(field, i);
  const Vertices vertices(
      field.lattice, i, Layer::before, SurfaceNet::kNone,
      [&](std::size_t block, std::size_t cell) { return net.vertex(block, cell); });
  std::vector<std::array<std::uint32_t, 3>> triangles;
  forEachPlace([&](const Vector3i& c) {
    if (vertices.at(c) == SurfaceNet::kNone) return;
    const bool inside = distances.at(c) < 0.0F;
    for (int axis = 0; axis < 3; ++axis) {
      if (inside == (distances.at(c + Vector3i::Unit(axis)) < 0.0F)) continue;
      const Vector3i u = Vector3i::Unit((axis + 1) % 3), v = Vector3i::Unit((axis + 2) % 3);
      std::array<std::uint32_t, 4> q = {vertices.at(c), vertices.at(c - u), vertices.at(c - u - v),
                                        vertices.at(c - v)};
      bool whole = true;
      for (const std::uint32_t corner : q) whole = whole && corner != SurfaceNet::kNone;
      if (!whole) continue;
      if (!inside) std::swap(q[1], q[3]);
      triangles.push_back({q[0], q[1], q[2]});
      triangles.push_back({q[0], q[2], q[3]});
    }
  });
  return triangles;
}

/// All lists in their order.
template <typename T>
std::vector<T> joined(std::vector<std::vector<T>>& lists) {
  std::size_t size = 0;
  for (const auto& list : lists) size += list.size();
  std::vector<T> all;
  all.reserve(size);
  for (auto& list : lists) {
    all.insert(all.end(), list.begin(), list.end());
    list = {};
  }
  return all;
}

}  // namespace

DistanceField::DistanceField(BlockLattice of)
    : lattice(std::move(of)), values(lattice.size() * BlockLattice::kCorners, kUnknown) {}

SurfaceNet surfaceNet(const DistanceField& field) {
  const std::size_t blocks = field.lattice.size();
  SurfaceNet net;
  net.place.assign(field.values.size(), SurfaceNet::kNoPlace);
  std::vector<std::vector<Vector3f>> points(blocks);
  parallelFor(blocks, kNetBlocksAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      points[i] = verticesOf(field, i, &net.place[i * BlockLattice::kCorners]);
    }
  });
  std::size_t before = 0;
  for (std::size_t i = 0; i < blocks; ++i) {
    net.first.push_back(static_cast<std::uint32_t>(before));
    before += points[i].size();
  }
  net.positions = joined(points);
  std::vector<std::vector<std::array<std::uint32_t, 3>>> triangles(blocks);
  parallelFor(blocks, kNetBlocksAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) triangles[i] = trianglesOf(field, i, net);
  });
  net.triangles = joined(triangles);
  return net;
}

}  // namespace pf

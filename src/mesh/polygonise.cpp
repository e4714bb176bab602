// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <utility>

#include "posefusion/core/parallel.hpp"
#include "posefusion/mesh/surface_nets.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;
using Distance = std::function<float(const Vector3f&)>;

constexpr int kGroup = 4;  // corners along each side that are sampled together
static_assert(BlockLattice::kSide % kGroup == 0);

/// Samples a group of corners; one sample decides whether the surface can be among them at all.
void sampleGroup(const Distance& distance, const BlockLattice& lattice, const Vector3i& corner,
                 const Vector3i& group, float* values) {
  const float reach = 1.3F * kGroup * lattice.cell_m();
  const Vector3f half = Vector3f::Constant(0.5F * (kGroup - 1) * lattice.cell_m());
  const float middle = distance(lattice.point(corner + group) + half);
  const bool far = std::abs(middle) > reach;
  for (int i = 0; i < kGroup * kGroup * kGroup; ++i) {
    const Vector3i c = group + Vector3i(i % kGroup, i / kGroup % kGroup, i / (kGroup * kGroup));
    values[BlockLattice::placeOf(c.x(), c.y(), c.z())] =
        far ? middle : distance(lattice.point(corner + c));
  }
}

/// `groups`: as many of them along each axis are in the box.
void sampleBlock(const Distance& distance, const Vector3i& groups, std::size_t i,
                 DistanceField& field) {
  constexpr int kGroups = BlockLattice::kSide / kGroup;
  const Vector3i corner = field.lattice.firstCorner(i);
  for (int k = 0; k < kGroups * kGroups * kGroups; ++k) {
    const Vector3i group =
        kGroup * Vector3i(k % kGroups, k / kGroups % kGroups, k / (kGroups * kGroups));
    if (((corner + group) / kGroup - groups).maxCoeff() >= 0) continue;
    sampleGroup(distance, field.lattice, corner, group, &field.values[i * BlockLattice::kCorners]);
  }
}

DistanceField sample(const Distance& distance, const Eigen::AlignedBox3f& box, float cell_m) {
  Vector3i groups, blocks;
  for (int axis = 0; axis < 3; ++axis) {
    const int corners = static_cast<int>(std::ceil(box.sizes()[axis] / cell_m)) + 2;
    groups[axis] = (corners + kGroup - 1) / kGroup;
    blocks[axis] = (kGroup * groups[axis] + BlockLattice::kSide - 1) / BlockLattice::kSide;
  }
  std::vector<std::uint64_t> keys;
  for (int i = 0; i < blocks.prod(); ++i) {
    keys.push_back(BlockLattice::keyOf(
        {i % blocks.x(), i / blocks.x() % blocks.y(), i / (blocks.x() * blocks.y())}));
  }
  DistanceField field(BlockLattice(box.min(), cell_m, std::move(keys)));
  parallelFor(field.lattice.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sampleBlock(distance, groups, i, field);
  });
  return field;
}

Vector3f gradient(const Distance& distance, const Vector3f& p, float step) {
  Vector3f g;
  for (int i = 0; i < 3; ++i) {
    const Vector3f d = step * Vector3f::Unit(i);
    g[i] = distance(p + d) - distance(p - d);
  }
  const float norm = g.norm();
  return norm > 0.0F ? Vector3f(g / norm) : Vector3f::UnitZ();
}

}  // namespace

TriangleMesh polygonise(const Distance& distance, const Eigen::AlignedBox3f& box, float cell_m) {
  SurfaceNet net = surfaceNet(sample(distance, box, cell_m));
  TriangleMesh mesh;
  mesh.positions = std::move(net.positions);
  mesh.triangles = std::move(net.triangles);
  mesh.normals.resize(mesh.size());
  parallelFor(mesh.size(), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      mesh.normals[i] = gradient(distance, mesh.positions[i], 0.4F * cell_m);
    }
  });
  return mesh;
}

}  // namespace pf

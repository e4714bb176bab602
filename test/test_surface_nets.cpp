// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <map>

#include "posefusion/mesh/surface_nets.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr float kRadius_m = 0.31F, kCell_m = 0.02F;

float sphere(const Vector3f& p) { return p.norm() - kRadius_m; }

TriangleMesh sphereMesh() {
  return polygonise(sphere, {Vector3f::Constant(-0.4F), Vector3f::Constant(0.4F)}, kCell_m);
}

/// How often each edge is passed from one corner to the other.
std::map<std::pair<std::uint32_t, std::uint32_t>, int> edgesOf(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  return edges;
}

TEST(SurfaceNets, ASphereIsClosedAndFacesOutwards) {
  const TriangleMesh mesh = sphereMesh();
  ASSERT_GT(mesh.size(), 2000U);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    EXPECT_LT(std::abs(sphere(mesh.positions[i])), 0.05F * kCell_m);
    EXPECT_GT(mesh.normals[i].dot(mesh.positions[i].normalized()), 0.999F);
  }
  for (const auto& t : mesh.triangles) {
    const Vector3f a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0.0F);
  }
  const auto edges = edgesOf(mesh);
  for (const auto& [edge, times] : edges) {
    EXPECT_EQ(times, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1U);
  }
}

TEST(SurfaceNets, OneThreadGivesTheBytesOfTwo) {
  const TriangleMesh two = sphereMesh();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const TriangleMesh one = sphereMesh();
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.triangles, two.triangles);
}

TEST(SurfaceNets, WhatIsNotKnownHasNoSurface) {
  BlockLattice lattice(Vector3f::Zero(), kCell_m,
                       {BlockLattice::keyOf({0, 0, 0}), BlockLattice::keyOf({-1, 0, 0})});
  DistanceField field(lattice);
  EXPECT_TRUE(surfaceNet(field).positions.empty());
  // The plane z = 3.5 cells, known on one side of x = 0 and one cell beyond.
  for (std::size_t i = 0; i < lattice.size(); ++i) {
    for (int k = 0; k < static_cast<int>(BlockLattice::kCorners); ++k) {
      const Vector3i c = lattice.firstCorner(i) + Vector3i(k % 8, k / 8 % 8, k / 64);
      if (c.x() > 1) continue;
      field.values[i * BlockLattice::kCorners + static_cast<std::size_t>(k)] =
          kCell_m * (static_cast<float>(c.z()) - 3.5F);
    }
  }
  const SurfaceNet net = surfaceNet(field);
  EXPECT_EQ(net.positions.size(), 9U * 7U);
  EXPECT_EQ(net.triangles.size(), 2U * 8U * 6U);  // across the border of the two blocks too
  for (const Vector3f& p : net.positions) {
    EXPECT_FLOAT_EQ(p.z(), 3.5F * kCell_m);
    EXPECT_LE(p.x(), kCell_m);
  }
}

TEST(BlockLattice, KeysNameBlocksOnBothSidesOfTheOrigin) {
  for (const Vector3i& block : {Vector3i(0, 0, 0), Vector3i(-1, 5, -700), Vector3i(9, -1, 1000)}) {
    EXPECT_EQ(BlockLattice::blockOf(BlockLattice::keyOf(block)), block);
  }
  const BlockLattice lattice({0, 0, 1}, 0.5F, {BlockLattice::keyOf({-1, 0, 0}), 3, 3});
  EXPECT_EQ(lattice.size(), 2U);
  EXPECT_EQ(lattice.block(lattice.find({-1, 0, 0})), Vector3i(-1, 0, 0));
  EXPECT_EQ(lattice.find({1, 1, 1}), BlockLattice::kNone);
  EXPECT_EQ(lattice.point({2, 0, -4}), Vector3f(1, 0, -1));
}

}  // namespace
}  // namespace pf

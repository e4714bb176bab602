// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "posefusion/core/error.hpp"
#include "posefusion/core/static_odds.hpp"
#include "posefusion/map/stable_surfels.hpp"
#include "posefusion/mesh/mesh_pieces.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;

/// A wavy sheet of 3 m, 1.5 cm apart, from `first_x_m` on.
SurfelArrays sheet(float first_x_m, float side_m = 3) {
  SurfelArrays s;
  const int count = static_cast<int>(side_m / 0.015F);
  s.resize(static_cast<std::size_t>(count * count));
  for (int i = 0; i < count * count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const float x = 0.015F * static_cast<float>(i % count),
                y = 0.015F * static_cast<float>(i / count);
    s.x[k] = first_x_m + x;
    s.y[k] = y - 1.5F;
    s.z[k] = 0.1F * std::sin(5 * x);
    const Vector3f n = Vector3f(-0.5F * std::cos(5 * x), 0, 1).normalized();
    s.nx[k] = n.x(), s.ny[k] = n.y(), s.nz[k] = n.z();
    s.r[k] = s.g[k] = 100, s.b[k] = 50 + 20 * y;
    s.radius[k] = 0.012F;
    s.weight[k] = 5;
    s.odds[k] = static_odds::kMost;
  }
  return s;
}

SurfelMap restoredMap(const SurfelArrays& surfels) {
  SurfelMap map{MapConfig{}};
  map.restore({{kFirstFragment, surfels}}, 9);
  return map;
}

MeshConfig coarse() {
  MeshConfig config;
  config.cell_m = 0.05;
  config.bridge_m = 0.05;
  return config;
}

/// Positions and colours of its corners, from the least corner on.
using Triangle = std::array<std::array<float, 6>, 3>;

std::vector<Triangle> trianglesOf(const TriangleMesh& mesh) {
  std::vector<Triangle> out;
  for (const auto& t : mesh.triangles) {
    Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3f& p = mesh.positions[t[k]];
      const MeshColor& c = mesh.colors[t[k]];
      triangle[k] = {p.x(), p.y(), p.z(), float(c[0]), float(c[1]), float(c[2])};
    }
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()),
                triangle.end());
    out.push_back(triangle);
  }
  return out;
}

/// Keeps what all updates together give.
class Listener {
 public:
  void take(const std::vector<MeshPieces::Piece>& pieces) {
    for (const auto& piece : pieces) pieces_[piece.key] = trianglesOf(piece.mesh);
  }
  std::vector<Triangle> all() const {
    std::vector<Triangle> out;
    for (const auto& [key, triangles] : pieces_) {
      out.insert(out.end(), triangles.begin(), triangles.end());
    }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  std::map<MeshPieces::Key, std::vector<Triangle>> pieces_;
};

std::vector<Triangle> wholeMesh(const SurfelMap& map) {
  auto all =
      trianglesOf(surfelMeshIfAny(stableSurfels(map, Eigen::Isometry3d::Identity()), coarse()));
  std::sort(all.begin(), all.end());
  return all;
}

TEST(MeshPieces, TogetherTheyAreTheMesh) {
  const SurfelMap map = restoredMap(sheet(-1));
  MeshPieces pieces(coarse(), 1);
  Listener listener;
  const auto first = pieces.update(map);
  listener.take(first);
  EXPECT_GE(first.size(), 9U);
  EXPECT_EQ(listener.all(), wholeMesh(map));
  EXPECT_TRUE(pieces.update(map).empty()) << "nothing has changed";
}

TEST(MeshPieces, OnlyWhatIsNearAChangeIsMadeAnew) {
  SurfelMap map = restoredMap(sheet(-1));
  MeshPieces pieces(coarse(), 0.5F);
  Listener listener;
  const std::size_t all = pieces.update(map).size();
  pieces.forget();
  listener.take(pieces.update(map));
  map.removeIf([](const SurfelArrays& s, std::size_t i) { return s.x[i] < -0.7F && s.y[i] < -1; });
  const auto changed = pieces.update(map);
  EXPECT_GT(changed.size(), 0U);
  EXPECT_LT(changed.size(), all / 2);
  listener.take(changed);
  EXPECT_EQ(listener.all(), wholeMesh(map));
  map.add(sheet(2.5F, 0.6F));
  listener.take(pieces.update(map));
  EXPECT_EQ(listener.all(), wholeMesh(map));
}

TEST(MeshPieces, AnotherMapTakesThePlaceOfTheOldOne) {
  MeshPieces pieces(coarse(), 1);
  Listener listener;
  listener.take(pieces.update(restoredMap(sheet(-1))));
  const SurfelMap other = restoredMap(sheet(5, 1));
  const auto changed = pieces.update(other);
  EXPECT_TRUE(std::any_of(changed.begin(), changed.end(),
                          [](const auto& p) { return p.mesh.triangles.empty(); }));
  listener.take(changed);
  EXPECT_EQ(listener.all(), wholeMesh(other));
  listener.take(pieces.update(SurfelMap{MapConfig{}}));
  EXPECT_TRUE(listener.all().empty());
}

TEST(MeshPieces, WhatIsInterruptedGoesOnWithTheNextCall) {
  const SurfelMap map = restoredMap(sheet(-1));
  MeshPieces pieces(coarse(), 1);
  Listener listener;
  int asked = 0;
  listener.take(pieces.update(map, [&] { return ++asked > 3; }));
  EXPECT_NE(listener.all(), wholeMesh(map));
  listener.take(pieces.update(map));
  EXPECT_EQ(listener.all(), wholeMesh(map));
}

TEST(MeshPieces, OtherFragmentsAndUnstableSurfelsAreNotShown) {
  SurfelMap map{MapConfig{}};
  SurfelArrays unstable = sheet(4, 1);
  std::fill(unstable.odds.begin(), unstable.odds.end(), 0.0F);
  map.restore({{kFirstFragment, unstable}, {kFirstFragment + 1, sheet(-1)}}, 9);
  EXPECT_TRUE(MeshPieces(coarse(), 1).update(map).empty());
  EXPECT_THROW(MeshPieces(coarse(), 0.1F), InputError);
}

}  // namespace
}  // namespace pf

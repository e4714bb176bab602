// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "posefusion/core/error.hpp"
#include "posefusion/core/static_odds.hpp"
#include "posefusion/mesh/surfel_mesh.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;

void add(SurfelArrays& s, const Vector3f& p, const Vector3f& n, const Vector3f& color) {
  s.forEachArray([](auto& array) { array.push_back(0); });
  s.x.back() = p.x(), s.y.back() = p.y(), s.z.back() = p.z();
  s.nx.back() = n.x(), s.ny.back() = n.y(), s.nz.back() = n.z();
  s.r.back() = color.x(), s.g.back() = color.y(), s.b.back() = color.z();
  s.radius.back() = 0.01F;
  s.weight.back() = 10;
  s.odds.back() = static_odds::kMost;
}

/// Surfels of a square of `side_m` at z = `z`, 1.3 cm apart; red where x < 0, blue elsewhere.
SurfelArrays square(float side_m, float z = 0, float facing = 1) {
  SurfelArrays s;
  const int count = static_cast<int>(side_m / 0.013F);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < count; ++k) {
      const float x = 0.013F * static_cast<float>(i) - side_m / 2,
                  y = 0.013F * static_cast<float>(k) - side_m / 2;
      add(s, {x, y, z}, {0, 0, facing}, x < 0 ? Vector3f(250, 0, 0) : Vector3f(0, 0, 250));
    }
  }
  return s;
}

/// Surfels all over a ball, by the golden angle.
SurfelArrays ball(float radius_m, int count) {
  SurfelArrays s;
  for (int i = 0; i < count; ++i) {
    const float z = 1 - (2 * static_cast<float>(i) + 1) / static_cast<float>(count);
    const float angle = 2.3999632F * static_cast<float>(i), across = std::sqrt(1 - z * z);
    const Vector3f n(across * std::cos(angle), across * std::sin(angle), z);
    add(s, radius_m * n, n, {100, 110, 120});
  }
  return s;
}

Vector3f facing(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vector3f a = mesh.positions[t[0]];
  return (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a).normalized();
}

TEST(SurfelMesh, ABallIsCoveredAndFacesOutwards) {
  constexpr float kRadius_m = 0.4F;
  const TriangleMesh mesh = surfelMesh(ball(kRadius_m, 12000), {});
  float area = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3f a = mesh.positions[t[0]];
    area += 0.5F * (mesh.positions[t[1]] - a).cross(mesh.positions[t[2]] - a).norm();
    EXPECT_GT(facing(mesh, t).dot(a.normalized()), 0.8F);
  }
  EXPECT_NEAR(area, 4 * M_PI * kRadius_m * kRadius_m, 0.03);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    EXPECT_NEAR(mesh.positions[i].norm(), kRadius_m, 0.002);
    EXPECT_GT(mesh.normals[i].dot(mesh.positions[i].normalized()), 0.99F);
    EXPECT_EQ(mesh.colors[i], MeshColor(100, 110, 120));
  }
}

TEST(SurfelMesh, ASquareEndsWhereItsSurfelsEnd) {
  const MeshConfig config;
  const TriangleMesh mesh = surfelMesh(square(0.6F), config);
  const auto most = static_cast<float>(0.3 + 1.4 * config.bridge_m);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    EXPECT_NEAR(mesh.positions[i].z(), 0, 1e-5);
    EXPECT_LT(mesh.positions[i].head<2>().cwiseAbs().maxCoeff(), most);
    if (mesh.positions[i].x() < -0.05F) EXPECT_EQ(mesh.colors[i], MeshColor(250, 0, 0));
    if (mesh.positions[i].x() > 0.05F) EXPECT_EQ(mesh.colors[i], MeshColor(0, 0, 250));
  }
  for (const auto& t : mesh.triangles) EXPECT_GT(facing(mesh, t).z(), 0.99F);
}

TEST(SurfelMesh, TheTwoSidesOfABoardStayApart) {
  SurfelArrays board = square(0.5F, 0.025F);
  board.append(square(0.5F, -0.005F, -1));
  const TriangleMesh mesh = surfelMesh(board, {});
  std::size_t above = 0, below = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    const Vector3f p = mesh.positions[i];
    if (p.head<2>().cwiseAbs().maxCoeff() > 0.2F) continue;
    const bool top = mesh.normals[i].z() > 0;
    EXPECT_NEAR(p.z(), top ? 0.025F : -0.005F, 1e-3);
    ++(top ? above : below);
  }
  EXPECT_NEAR(static_cast<double>(above), static_cast<double>(below), 0.05 * above);
}

TEST(SurfelMesh, GapsCloseUpToTheBridgeAndNoFurther) {
  for (const float gap_m : {0.05F, 0.16F}) {
    SurfelArrays torn;
    const SurfelArrays whole = square(0.6F);
    for (std::uint32_t i = 0; i < whole.size(); ++i) {
      if (std::abs(whole.x[i]) > gap_m / 2) torn.append(whole, &i, 1);
    }
    std::size_t in_gap = 0;
    for (const Vector3f& p : surfelMesh(torn, {}).positions) {
      in_gap += std::abs(p.x()) < 0.02F && std::abs(p.y()) < 0.2F ? 1 : 0;
    }
    EXPECT_EQ(in_gap > 0, gap_m < 0.1F) << gap_m;
  }
}

TEST(SurfelMesh, AQuarterTurnTurnsTheMesh) {
  const SurfelArrays upright = ball(0.3F, 8000);
  SurfelArrays turned = upright;
  for (std::size_t i = 0; i < upright.size(); ++i) {
    turned.x[i] = -upright.y[i], turned.y[i] = upright.x[i];
    turned.nx[i] = -upright.ny[i], turned.ny[i] = upright.nx[i];
  }
  const TriangleMesh a = surfelMesh(upright, {}), b = surfelMesh(turned, {});
  EXPECT_NEAR(static_cast<double>(a.size()), static_cast<double>(b.size()), 0.002 * a.size());
  for (std::size_t i = 0; i < a.size(); i += 50) {
    const Vector3f p(-a.positions[i].y(), a.positions[i].x(), a.positions[i].z());
    float nearest = 1;
    for (const Vector3f& q : b.positions) nearest = std::min(nearest, (p - q).norm());
    EXPECT_LT(nearest, 1e-4F);
  }
}

TEST(SurfelMesh, OneThreadGivesTheBytesOfTwo) {
  const SurfelArrays surfels = ball(0.5F, 20000);
  const TriangleMesh two = surfelMesh(surfels, {});
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const TriangleMesh one = surfelMesh(surfels, {});
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.normals, two.normals);
  EXPECT_EQ(one.colors, two.colors);
  EXPECT_EQ(one.triangles, two.triangles);
}

TEST(SurfelMesh, WhatIsNotANumberSpoilsNothing) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  SurfelArrays s = square(0.5F);
  for (std::size_t i = 0; i < s.size(); i += 7) {
    (i % 4 == 0 ? s.r : i % 4 == 1 ? s.nx : i % 4 == 2 ? s.x : s.weight)[i] = kNaN;
  }
  s.z[3] = std::numeric_limits<float>::infinity();
  s.x[5] = 3e38F;
  const TriangleMesh mesh = surfelMesh(s, {});
  EXPECT_GT(mesh.triangles.size(), 1000U);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    EXPECT_NEAR(mesh.positions[i].z(), 0, 1e-4);
    EXPECT_NEAR(mesh.normals[i].norm(), 1, 1e-4);
  }
  std::fill(s.r.begin(), s.r.end(), kNaN);
  EXPECT_EQ(surfelMesh(s, {}).colors.front(), MeshColor::Constant(128));
}

std::string refusal(const SurfelArrays& surfels, const MeshConfig& config) {
  try {
    surfelMesh(surfels, config);
  } catch (const InputError& error) {
    return error.what();
  }
  return "made";
}

TEST(SurfelMesh, WhatCannotBeMadeIsRefused) {
  EXPECT_EQ(refusal({}, {}),
            "mesh: 0 stable surfels are too few for a surface, expected at least 2 beside each "
            "other");
  SurfelArrays one;
  add(one, {0, 0, 0}, {0, 0, 1}, {0, 0, 0});
  EXPECT_NE(refusal(one, {}).find("1 stable surfels are too few"), std::string::npos);
  MeshConfig config;
  config.cell_m = 0;
  EXPECT_NE(refusal(square(0.5F), config).find("cell: is 0.000000, expected 0.0001 to 1 m"),
            std::string::npos);
  config.cell_m = 0.001;
  config.memory_limit_mb = 50;
  const std::string text = refusal(square(0.5F), config);
  EXPECT_NE(text.find("a mesh with cells of 0.001 m takes about"), std::string::npos) << text;
  EXPECT_NE(text.find("expected at most 50 MB"), std::string::npos) << text;
}

}  // namespace
}  // namespace pf

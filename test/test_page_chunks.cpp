// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "posefusion/core/error.hpp"
#include "posefusion/mesh/page_fit.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

MeshColor colorOf(std::size_t number) {
  return {static_cast<unsigned char>(number & 255), static_cast<unsigned char>(number >> 8 & 255),
          static_cast<unsigned char>(number >> 16)};
}
std::size_t numberOf(const PageVertex& v) {
  return v.color[0] + 256U * v.color[1] + 65536U * v.color[2];
}

/// A wavy sheet of 12 x 9 m with `side` x `side` vertices; the colour of each is its number.
TriangleMesh sheetOf(std::uint32_t side) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const float u = static_cast<float>(i % side) / static_cast<float>(side - 1),
                v = static_cast<float>(i / side) / static_cast<float>(side - 1);
    mesh.positions.emplace_back(12 * u - 5, 9 * v + 3, std::sin(20 * u) * std::cos(15 * v));
    mesh.normals.push_back(
        Vector3f(std::sin(40 * u), std::cos(40 * u), std::sin(50 * v)).normalized());
    mesh.colors.push_back(colorOf(i));
  }
  for (std::uint32_t row = 0; row + 1 < side; ++row) {
    for (std::uint32_t i = row * side; i + 1 < (row + 1) * side; ++i) {
      mesh.triangles.push_back({i, i + 1, i + side});
      mesh.triangles.push_back({i + 1, i + side + 1, i + side});
    }
  }
  return mesh;
}

SurfelArrays surfels(std::size_t count) {
  SurfelArrays s;
  s.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    s.x[i] = 0.01F * static_cast<float>(i % 400);
    s.y[i] = 0.01F * static_cast<float>(i / 400);
    s.z[i] = 0.5F;
    s.nz[i] = 1;
    s.r[i] = 10, s.g[i] = 20, s.b[i] = 300;
    s.radius[i] = i % 2 == 0 ? 0.02F : 0.01F;
    s.weight[i] = 5;
  }
  return s;
}

TEST(PageChunks, EveryTriangleComesBackWithinTheStepOfItsChunk) {
  const TriangleMesh mesh = sheetOf(400);
  const auto chunks = pageChunks(mesh);
  EXPECT_GE(chunks.size(), 3U);  // 160,000 vertices
  std::multiset<std::array<std::size_t, 3>> expected, found;
  for (const auto& t : mesh.triangles) expected.insert({t[0], t[1], t[2]});
  for (const PageChunk& chunk : chunks) {
    ASSERT_LE(chunk.vertices.size(), PageChunk::kMostVertices);
    const float most_m = 0.5F * chunk.side.maxCoeff() / 65535 + 2e-6F;  // and that of floats
    for (std::size_t i = 0; i < chunk.indices.size(); i += 3) {
      std::array<std::size_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_LT(chunk.indices[i + k], chunk.vertices.size());
        const PageVertex& vertex = chunk.vertices[chunk.indices[i + k]];
        triangle[k] = numberOf(vertex);
        const Vector3f off = positionOf(chunk, vertex) - mesh.positions[triangle[k]];
        ASSERT_LE(off.cwiseAbs().maxCoeff(), most_m);
        const float cosine = normalOf(vertex).dot(mesh.normals[triangle[k]]);
        ASSERT_GT(cosine, std::cos(1.2F * static_cast<float>(M_PI) / 180));
      }
      found.insert(triangle);
    }
  }
  EXPECT_EQ(found, expected);
}

TEST(PageChunks, TheSameMeshGivesTheSameChunks) {
  const TriangleMesh mesh = sheetOf(300);
  const auto a = pageChunks(mesh), b = pageChunks(mesh);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].indices, b[i].indices);
}

TEST(PageChunks, ASurfelWithoutColourIsGreyAndOneWithoutPlaceIsLeftOut) {
  SurfelArrays s = surfels(5);
  s.r[1] = kNan;
  s.x[2] = kNan;
  s.nz[3] = kNan;
  s.radius[4] = kNan;
  const auto chunks = pageChunks(s);
  ASSERT_EQ(chunks.size(), 1U);
  ASSERT_EQ(chunks[0].vertices.size(), 2U);
  EXPECT_EQ(chunks[0].vertices[0].color, (std::array<std::uint8_t, 3>{10, 20, 255}));
  EXPECT_EQ(chunks[0].vertices[1].color, (std::array<std::uint8_t, 3>{128, 128, 128}));
  EXPECT_EQ(chunks[0].vertices[0].radius, 255);
  EXPECT_EQ(chunks[0].vertices[1].radius, 128);
  EXPECT_FLOAT_EQ(chunks[0].largest_radius_m, 0.02F);
  EXPECT_NEAR(positionOf(chunks[0], chunks[0].vertices[1]).x(), 0.01, 1e-6);
  EXPECT_TRUE(pageChunks(SurfelArrays()).empty());
}

TEST(PageChunks, OneSurfelHasAPlaceToo) {
  const auto chunks = pageChunks(surfels(1));
  ASSERT_EQ(chunks.size(), 1U);
  EXPECT_EQ(positionOf(chunks[0], chunks[0].vertices[0]), Vector3f(0, 0, 0.5F));
  EXPECT_EQ(normalOf(chunks[0].vertices[0]), Vector3f(0, 0, 1));
}

TEST(PageFit, WhatHasNoRoomIsMadeCoarser) {
  const SurfelArrays s = surfels(160000);
  const PageGeometry fine = pageSurfels(s, 10'000'000), coarse = pageSurfels(s, 200'000);
  EXPECT_EQ(fine.vertices, s.size());
  EXPECT_EQ(fine.step_m, 0);
  EXPECT_LE(coarse.bytes(), 200'000U);
  EXPECT_GT(coarse.bytes(), 100'000U);
  EXPECT_GT(coarse.step_m, 0.02);
  const PageGeometry mesh = pageMesh(s, {}, 10'000'000), small = pageMesh(s, {}, 200'000);
  EXPECT_EQ(mesh.step_m, MeshConfig().cell_m);
  EXPECT_GT(mesh.bytes(), 200'000U);
  EXPECT_LE(small.bytes(), 200'000U);
  EXPECT_GT(small.triangles, mesh.triangles / 10);
  EXPECT_NE(errorOf([&] { pageSurfels(s, 3); }).find("3 bytes of the map"), std::string::npos);
  EXPECT_NE(errorOf([&] { pageMesh(s, {}, 3); }).find("3 bytes of the map"), std::string::npos);
}

TEST(PageFit, NothingToShowIsRefused) {
  SurfelArrays s = surfels(2);
  s.x[0] = s.y[1] = kNan;
  EXPECT_NE(errorOf([&] { pageSurfels(s, 1000); }).find("none of 2 stable surfels"),
            std::string::npos);
  EXPECT_NE(errorOf([&] { pageMesh({}, {}, 1000); }).find("0 stable surfels are too few"),
            std::string::npos);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "posefusion/evaluation/surface_check.hpp"

namespace pf {
namespace {

constexpr int kSide = 50;  // surfels along each side of a wall
constexpr float kStep_m = 0.01F;

/// Adds surfels of the plane z = `z` for rows [first, last), facing down z (or up, `away`).
void addWall(SurfelArrays& s, float z, int first = 0, int last = kSide, bool away = false) {
  for (int v = first; v < last; ++v) {
    for (int u = 0; u < kSide; ++u) {
      s.forEachArray([](auto& array) { array.push_back(0); });
      s.x.back() = kStep_m * static_cast<float>(u);
      s.y.back() = kStep_m * static_cast<float>(v);
      s.z.back() = z;
      s.nz.back() = away ? 1.0F : -1.0F;
      s.radius.back() = 0.008F;
    }
  }
}

/// Adds the plane z = `z`, larger than the walls, every 3 cm.
void addTruth(SurfaceSamples& truth, float z, bool away = false) {
  for (int v = -4; v < 21; ++v) {
    for (int u = -4; u < 21; ++u) {
      truth.positions.emplace_back(0.03F * static_cast<float>(u), 0.03F * static_cast<float>(v), z);
      truth.normals.emplace_back(0.0F, 0.0F, away ? 1.0F : -1.0F);
    }
  }
}

SurfaceSamples wallTruth() {
  SurfaceSamples truth;
  addTruth(truth, 2.0F);
  return truth;
}

double layerShare(const SurfelArrays& surfels, const SurfaceSamples& truth) {
  return checkSurface(surfels, Eigen::Isometry3d::Identity(), truth).layerShare();
}

TEST(SurfaceCheck, DistanceIsTheOffsetOfAWall) {
  SurfelArrays surfels;
  addWall(surfels, 2.004F);                    // 50 rows
  addWall(surfels, 1.97F, 0, kSide * 4 / 5);   // 40 rows
  addWall(surfels, 1.90F, 0, kSide * 1 / 10);  // 5 rows of 95: the last 5.3 %
  const SurfaceScore score = checkSurface(surfels, Eigen::Isometry3d::Identity(), wallTruth());
  EXPECT_EQ(score.surfels, 95U * kSide);
  EXPECT_NEAR(score.median_m, 0.004, 1e-5);
  EXPECT_NEAR(score.p95_m, 0.10, 1e-5);
}

TEST(SurfaceCheck, DistanceBesideASurfaceGoesToItsRim) {
  SurfelArrays surfels;
  addWall(surfels, 2.0F, 0, 1);
  surfels.resize(3);
  for (std::size_t i = 0; i < 3; ++i) surfels.y[i] = 0;
  surfels.x = {0.63F + 0.2F, 0.63F + 0.03F, 100.0F};  // the last sample lies at 0.60, radius 0.03
  const auto distances = distancesToSurface(surfels, Eigen::Isometry3d::Identity(), wallTruth());
  EXPECT_NEAR(distances[0], 0.20, 1e-4);
  EXPECT_NEAR(distances[1], 0.03, 1e-4);
  EXPECT_EQ(distances[2], kFarFromSurface_m);
}

TEST(SurfaceCheck, TheMapIsBroughtToTheTruth) {
  SurfelArrays surfels;
  addWall(surfels, 2.0F);
  Eigen::Isometry3d T_truth_map = Eigen::Isometry3d::Identity();
  T_truth_map.translation().z() = 0.012;
  const SurfaceScore score = checkSurface(surfels, T_truth_map, wallTruth());
  EXPECT_NEAR(score.median_m, 0.012, 1e-5);
}

TEST(TwoLayers, AreAllSurfelsThatHaveAnotherBehind) {
  SurfelArrays surfels;
  addWall(surfels, 2.0F);                 // 50 rows,
  addWall(surfels, 2.05F, 0, kSide / 5);  // and 10 behind: 20 of 60 have another
  EXPECT_NEAR(layerShare(surfels, wallTruth()), 20.0 / 60.0, 1e-9);
}

TEST(TwoLayers, AreTwoToFifteenCentimetresApart) {
  for (const auto& [apart, share] :
       {std::pair{0.015F, 0.0}, {0.025F, 1.0}, {0.145F, 1.0}, {0.155F, 0.0}}) {
    SurfelArrays surfels;
    addWall(surfels, 2.0F);
    addWall(surfels, 2.0F + apart);
    EXPECT_EQ(layerShare(surfels, wallTruth()), share) << apart;
  }
}

TEST(TwoLayers, AreNoneWhereTheTruthHasTwoSurfaces) {
  SurfaceSamples truth = wallTruth();
  addTruth(truth, 2.05F);
  SurfelArrays surfels;
  addWall(surfels, 2.003F);
  addWall(surfels, 2.046F);
  EXPECT_EQ(layerShare(surfels, truth), 0.0);
  // Both of these belong to the first of the two.
  SurfelArrays near_one;
  addWall(near_one, 1.96F);
  addWall(near_one, 2.003F);
  EXPECT_EQ(layerShare(near_one, truth), 1.0);
}

TEST(TwoLayers, AreNoneOfTheTwoSidesOfABoard) {
  SurfaceSamples truth = wallTruth();
  addTruth(truth, 2.03F, true);
  SurfelArrays surfels;
  addWall(surfels, 2.0F);
  addWall(surfels, 2.03F, 0, kSide, true);
  EXPECT_EQ(layerShare(surfels, truth), 0.0);
}

TEST(TwoLayers, CountWhereThereIsNoTruth) {
  SurfelArrays surfels;
  addWall(surfels, 1.0F);
  addWall(surfels, 1.05F);
  EXPECT_EQ(layerShare(surfels, wallTruth()), 1.0);
}

TEST(SurfaceCheck, NothingHasNoScore) {
  const SurfaceScore score = checkSurface({}, Eigen::Isometry3d::Identity(), wallTruth());
  EXPECT_EQ(score.surfels, 0U);
  EXPECT_EQ(score.median_m, 0.0);
  EXPECT_EQ(score.layerShare(), 0.0);
}

TEST(SurfaceCheck, ThreadsDoNotMatter) {
  SurfelArrays surfels;
  addWall(surfels, 2.0F);
  addWall(surfels, 2.05F, 0, 7);
  const auto both = [&] {
    const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    return std::pair{distancesToSurface(surfels, T, wallTruth()),
                     surfelsInTwoLayers(surfels, T, wallTruth())};
  };
  const auto many = both();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(both(), many);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/map_points.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "place_scene.hpp"
#include "posefusion/loop/place_search.hpp"

namespace pf {
namespace {

TEST(Levels, UpIsThatOfTheRoom) {
  // The camera of the small room looks a little down: up is not the picture's up.
  const auto frame_levels = placeQuery(room().frame(11));
  ASSERT_TRUE(frame_levels.floor);
  const Eigen::Vector3d seen = room().sequence.pose(11).linear() * frame_levels.floor->up;
  EXPECT_GT(seen.dot(room().up), std::cos(0.035));
}

TEST(Levels, NoneWhereNothingFacesUp) {
  const std::vector<float> zero(100, 0.0F), one(100, 1.0F);
  const OrientedPoints wall{zero.data(), zero.data(), one.data(), zero.data(),
                            zero.data(), one.data(),  100};
  EXPECT_FALSE(findLevels(wall, Eigen::Vector3d::UnitY(), 0.5));
}

TEST(MapPoints, AreThinAndStable) {
  const MapPoints& points = room().points.front();
  ASSERT_GT(points.size(), 100U);
  EXPECT_LT(points.size(), room().map.stableCount() / 2);
  const MapPoints coarse = thinnedPoints(room().map, kFirstFragment, 0.2);
  EXPECT_LT(coarse.size(), points.size() / 2);
}

TEST(MapPoints, CoarserOnesAreOnTheSameSurfaces) {
  // Two walls that meet, and the back of one of them.
  MapPoints walls;
  for (int i = 0; i < 3000; ++i) {
    const int wall = i % 3;
    const float a = 0.011F * static_cast<float>(i / 3 % 50),
                b = 0.017F * static_cast<float>(i / 150);
    walls.x.push_back(wall == 1 ? 0.7F : a + 0.13F);
    walls.y.push_back(wall == 1 ? a + 0.01F : 0.01F);
    walls.z.push_back(b - 0.3F);
    walls.nx.push_back(wall == 1 ? -1.0F : 0.0F);
    walls.ny.push_back(wall == 1 ? 0.0F : wall == 0 ? 1.0F : -1.0F);
    walls.nz.push_back(0.0F);
    walls.intensity.push_back(wall == 1 ? 200.0F : 50.0F);
  }
  const MapPoints coarse = coarser(walls, 0.12);
  EXPECT_LT(coarse.size(), walls.size() / 20);
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    const bool is_second = coarse.nx[i] != 0;
    EXPECT_NEAR(is_second ? coarse.x[i] - 0.7F : coarse.y[i] - 0.01F, 0.0F, 1e-5F);
    EXPECT_NEAR(std::abs(is_second ? coarse.nx[i] : coarse.ny[i]), 1.0F, 1e-5F);
    EXPECT_NEAR(coarse.intensity[i], is_second ? 200.0F : 50.0F, 1e-3F);
  }
  const MapPoints again = coarser(coarse, 0.12);
  EXPECT_EQ(again.size(), coarse.size()) << "each is alone in its voxel already";
}

}  // namespace
}  // namespace pf

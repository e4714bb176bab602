// SPDX-License-Identifier: BSD-3-Clause
// What the rviz display tells of a room: its size and its floor.
#include "../../src/viewer/room_fit.hpp"

#include <gtest/gtest.h>

#include <random>

namespace posefusion_ros {
namespace {

using Eigen::Vector3f;

SurfelPoint surfelAt(const Vector3f& p, const Vector3f& n) {
  return {p.x(), p.y(), p.z(), 0, n.x(), n.y(), n.z(), 0.01F, 10};
}

/// A room 6 x 4 x 2.5 m around (1, 2), floor at z = -1.2 m, with a table, tilted about the origin.
std::vector<SurfelPoint> roomTilted(float angle_rad) {
  std::vector<SurfelPoint> surfels;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> part(0, 1);
  const Eigen::AngleAxisf tilt(angle_rad, Vector3f(1, 1, 0).normalized());
  const auto add = [&](int count, const Vector3f& from, const Vector3f& size,
                       const Vector3f& normal) {
    for (int i = 0; i < count; ++i) {
      const Vector3f p =
          from + size.cwiseProduct(Vector3f(part(random), part(random), part(random)));
      surfels.push_back(surfelAt(tilt * p, tilt * normal));
    }
  };
  add(4000, {-2, 0, -1.2F}, {6, 4, 0}, {0, 0, 1});
  add(4000, {-2, 0, 1.3F}, {6, 4, 0}, {0, 0, -1});
  add(3000, {-2, 0, -1.2F}, {6, 0, 2.5F}, {0, 1, 0});
  add(3000, {4, 0, -1.2F}, {0, 4, 2.5F}, {-1, 0, 0});
  add(1500, {0, 1, -0.5F}, {2, 1, 0}, {0, 0, 1});
  return surfels;
}

TEST(RoomFit, TheFloorIsTheLowestLargePlaneThatFacesUp) {
  for (const float angle : {0.0F, 0.1F, 0.3F}) {
    const auto floor = floorOf(roomTilted(angle));
    ASSERT_TRUE(floor) << angle;
    const Vector3f expected =
        Eigen::AngleAxisf(angle, Vector3f(1, 1, 0).normalized()) * Vector3f::UnitZ();
    EXPECT_GT(floor->normal.dot(expected), 0.9999F) << angle;
    EXPECT_NEAR(floor->height, -1.2F, 0.02F) << angle;
  }
}

TEST(RoomFit, WithoutAFloorThereIsNone) {
  EXPECT_FALSE(floorOf({}));
  std::vector<SurfelPoint> wall;
  for (int i = 0; i < 1000; ++i)
    wall.push_back(surfelAt({0, 0.01F * static_cast<float>(i), 0}, Vector3f::UnitX()));
  EXPECT_FALSE(floorOf(wall));
}

TEST(RoomFit, StraySurfelsDoNotMakeTheRoomLarger) {
  auto surfels = roomTilted(0);
  for (int i = 0; i < 50; ++i) surfels.push_back(surfelAt({100, 100, 100}, Vector3f::UnitX()));
  const Eigen::AlignedBox3f box = boundsOf(surfels);
  EXPECT_NEAR(box.min().x(), -2, 0.1);
  EXPECT_NEAR(box.max().x(), 4, 0.1);
  EXPECT_NEAR(box.max().y(), 4, 0.1);
  EXPECT_NEAR(box.min().z(), -1.2, 0.05);
  EXPECT_NEAR(box.max().z(), 1.3, 0.05);
  EXPECT_TRUE(boundsOf({}).isEmpty());
}

}  // namespace
}  // namespace posefusion_ros

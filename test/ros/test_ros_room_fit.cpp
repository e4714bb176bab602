// SPDX-License-Identifier: BSD-3-Clause
// The size and the floor of a room that the rviz display finds, and how much of it is drawn.
#include "../../src/viewer/room_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "../../src/viewer/fluid_limit.hpp"

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
    EXPECT_GT(floor->up.cast<float>().dot(expected), 0.9999F) << angle;
    EXPECT_NEAR(floor->lowest_m, -1.2, 0.02) << angle;
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

/// A machine that takes so long for a frame and for each disc of it.
struct Machine {
  double frame_s, disc_s;
};

/// Frames a second after `seconds` of drawing `all` discs, as many as the limit allows.
double rateAfter(double seconds, std::size_t all, const Machine& machine, FluidLimit& limit) {
  double frame_s = 0;
  for (double t = 0; t < seconds; t += frame_s) {
    const std::size_t limited = std::min(all, limit.discs());
    const std::size_t shown = all / ((all + limited - 1) / limited);  // every so many-th
    frame_s = std::max(1.0 / 30, machine.frame_s + machine.disc_s * static_cast<double>(shown));
    limit.drawn(static_cast<float>(frame_s), shown, all);
  }
  return 1 / frame_s;
}

TEST(FluidLimit, ASlowMachineDrawsFewerDiscsAndStaysAtThat) {
  for (const double disc_s : {4e-7, 2e-6}) {
    FluidLimit limit;
    const Machine machine{0.03, disc_s};
    EXPECT_GT(rateAfter(12, 1000000, machine, limit), 8) << disc_s;
    const std::size_t settled = limit.discs();
    EXPECT_GE(settled, disc_s < 1e-6 ? 100000U : 30000U);
    EXPECT_GT(rateAfter(60, 1000000, machine, limit), 8) << disc_s;
    EXPECT_EQ(limit.discs(), settled) << "it does not go up and down";
  }
}

TEST(FluidLimit, AFastMachineDrawsAll) {
  FluidLimit limit;
  EXPECT_GT(rateAfter(20, 1000000, {0.01, 1e-8}, limit), 25);
  EXPECT_GE(limit.discs(), 1000000U);
}

TEST(FluidLimit, AMachineThatWasBusyDrawsAllAgain) {
  FluidLimit limit;
  rateAfter(20, 1000000, {0.05, 2e-6}, limit);
  ASSERT_LT(limit.discs(), 100000U);
  rateAfter(40, 1000000, {0.01, 1e-8}, limit);
  EXPECT_GE(limit.discs(), 1000000U);
}

}  // namespace
}  // namespace posefusion_ros

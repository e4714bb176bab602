// SPDX-License-Identifier: BSD-3-Clause
// The grid of a map that grows, against that of the whole map at once.
#include <gtest/gtest.h>

#include <cmath>

#include "mapper_scene.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/grid/floor_map.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {
namespace {

class FloorMapTest : public MapperTest {
 protected:
  void map(int from, int to) {
    for (int i = from; i < to; ++i) mapper.process({room().frame(i).frame, {}, {}});
  }
  MapParts parts() const {
    return {mapper.map(), camera, mapper.backEnd().graph().keyframes(), mapper.worldFromMap()};
  }

  Mapper mapper{config()};
  const PinholeCamera camera = room().frame(0).frame.camera;
};

/// The state of the cell at a place of the floor; unknown beside the grid.
int stateAt(const OccupancyGrid& grid, double x_m, double y_m) {
  const int x = static_cast<int>(std::floor((x_m - grid.low_x_m) / grid.cell_m)),
            y = static_cast<int>(std::floor((y_m - grid.low_y_m) / grid.cell_m));
  const bool is_inside = x >= 0 && y >= 0 && x < grid.cells.cols && y < grid.cells.rows;
  return is_inside ? grid.at(x, y) : OccupancyGrid::kUnknown;
}

TEST_F(FloorMapTest, TheGrowingGridIsThatOfTheWholeMap) {
  GrowingGrid growing((GridConfig()));
  map(0, 20);
  const auto first = growing.update(parts());
  ASSERT_TRUE(first);
  map(20, 60);
  const auto last = growing.update(parts());
  ASSERT_TRUE(last);
  const FloorMap whole = floorMapOf(parts());
  const OccupancyGrid expected = gridOf(whole, {});
  // The floors may differ by a centimetre: what lies well within free space is compared.
  const Eigen::Isometry3d T = last->T_world_floor.inverse() * whole.T_floor_world.inverse();
  EXPECT_LT(T.translation().norm(), 0.011);
  int free = 0, same = 0;
  for (int y = 1; y + 1 < expected.cells.rows; ++y) {
    for (int x = 1; x + 1 < expected.cells.cols; ++x) {
      if (expected.at(x, y) != OccupancyGrid::kFree) continue;
      const Eigen::Vector3d p =
          T * Eigen::Vector3d(expected.low_x_m + (x + 0.5) * expected.cell_m,
                              expected.low_y_m + (y + 0.5) * expected.cell_m, 0);
      ++free;
      same += stateAt(last->grid, p.x(), p.y()) == OccupancyGrid::kFree ? 1 : 0;
    }
  }
  EXPECT_GT(free, 200);
  EXPECT_GT(same, 0.95 * free);
  EXPECT_GT(last->grid.count(OccupancyGrid::kFree), first->grid.count(OccupancyGrid::kFree));
}

TEST_F(FloorMapTest, CellsStayWhereTheyAre) {
  GrowingGrid growing((GridConfig()));
  map(0, 30);
  const auto a = growing.update(parts());
  map(30, 35);
  const auto b = growing.update(parts());
  ASSERT_TRUE(a && b);
  EXPECT_TRUE(a->T_world_floor.isApprox(b->T_world_floor, 1e-12));
  const double steps = (b->grid.low_x_m - a->grid.low_x_m) / a->grid.cell_m;
  EXPECT_NEAR(steps, std::round(steps), 1e-6);
}

TEST_F(FloorMapTest, WhatIsStoppedGivesNothingAndWhatHasNoFloorIsRefused) {
  GrowingGrid growing((GridConfig()));
  EXPECT_THROW(growing.update(parts()), InputError);
  map(0, 20);
  EXPECT_FALSE(growing.update(parts(), [] { return true; }));
  EXPECT_TRUE(growing.update(parts()));
  mapper.reset();
  EXPECT_THROW(growing.update(parts()), InputError);
  map(0, 20);
  EXPECT_TRUE(growing.update(parts())) << "another map";
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/evaluation/grid_check.hpp"
#include "posefusion/grid/floor.hpp"
#include "posefusion/grid/occupancy_grid.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/grid_file.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;

void add(SurfelArrays& s, const Vector3f& p, const Vector3f& n) {
  s.forEachArray([](auto& array) { array.push_back(0); });
  s.x.back() = p.x(), s.y.back() = p.y(), s.z.back() = p.z();
  s.nx.back() = n.x(), s.ny.back() = n.y(), s.nz.back() = n.z();
  s.radius.back() = 0.015F;
}

/// A floor of 4 x 3 m, a wall 2 m high where it ends at x = 4, a table top at 0.7 m.
SurfelArrays room() {
  SurfelArrays s;
  for (int i = 0; i < 200; ++i) {
    for (int k = 0; k < 150; ++k) {
      const float x = 0.02F * static_cast<float>(i), y = 0.02F * static_cast<float>(k);
      add(s, {x, y, 0}, {0, 0, 1});
      if (k < 100) add(s, {4.01F, 0.015F * static_cast<float>(i), y}, {-1, 0, 0});
      if (x > 1 && x < 1.8F && y > 1 && y < 1.6F) add(s, {x, y, 0.7F}, {0, 0, 1});
    }
  }
  return s;
}

OccupancyGrid gridOf(const SurfelArrays& surfels, const std::vector<SeenPoints>& seen) {
  GridMaker maker(surfels, {});
  for (const SeenPoints& view : seen) maker.add(view);
  return maker.grid();
}

std::int8_t stateAt(const OccupancyGrid& grid, double x, double y) {
  return grid.at(static_cast<int>((x - grid.low_x_m) / grid.cell_m),
                 static_cast<int>((y - grid.low_y_m) / grid.cell_m));
}

/// From 1.4 m over (0.5, 2.5): a strip of the floor and the wall behind it.
SeenPoints strip() {
  SeenPoints seen;
  seen.from = {0.5F, 2.5F, 1.4F};
  for (int i = 0; i < 400; ++i) {
    const float share = 0.01F * static_cast<float>(i);
    for (const float y : {2.5F, 2.52F}) {
      if (share <= 4) seen.points.emplace_back(share, y, 0.0F);
      seen.points.emplace_back(4.01F, y, 0.004F * static_cast<float>(i));
    }
  }
  return seen;
}

TEST(Floor, IsFoundUnderATableHoweverTheMapLeans) {
  SurfelArrays s = room();
  Eigen::Isometry3d T_lean = Eigen::Isometry3d::Identity();
  T_lean.linear() = expSo3(Eigen::Vector3d(0.1, -0.08, 0));
  T_lean.translation() << 1, 2, -1.3;
  const Eigen::Isometry3f T = T_lean.cast<float>();
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vector3f p = T * Vector3f(s.x[i], s.y[i], s.z[i]);
    const Vector3f n = T.linear() * Vector3f(s.nx[i], s.ny[i], s.nz[i]);
    s.x[i] = p.x(), s.y[i] = p.y(), s.z[i] = p.z();
    s.nx[i] = n.x(), s.ny[i] = n.y(), s.nz[i] = n.z();
  }
  const Eigen::Isometry3d T_floor_room = floorFrame(s) * T_lean;
  EXPECT_NEAR((T_floor_room * Eigen::Vector3d(0, 0, 0)).z(), 0, 0.002);
  EXPECT_NEAR((T_floor_room * Eigen::Vector3d(4, 3, 0)).z(), 0, 0.002);
  EXPECT_NEAR(T_floor_room.linear()(2, 2), 1, 1e-5);
  EXPECT_THROW(floorFrame({}), InputError);
}

TEST(OccupancyGrid, WhatStandsIsOccupiedWhatWasSeenIsFreeTheRestIsUnknown) {
  const OccupancyGrid grid = gridOf(room(), {strip()});
  EXPECT_EQ(stateAt(grid, 4.01, 1.0), OccupancyGrid::kOccupied);
  EXPECT_EQ(stateAt(grid, 1.4, 1.3), OccupancyGrid::kOccupied);
  EXPECT_EQ(stateAt(grid, 2.5, 2.51), OccupancyGrid::kFree);
  EXPECT_EQ(stateAt(grid, 3.9, 2.51), OccupancyGrid::kFree);
  EXPECT_EQ(stateAt(grid, 2.5, 0.5), OccupancyGrid::kUnknown);  // no ray, though there is floor
  EXPECT_EQ(gridOf(room(), {}).count(OccupancyGrid::kFree), 0U);
}

TEST(OccupancyGrid, ALookUnderATableShowsNothingOfItsTop) {
  SeenPoints low;
  low.from = {3.5F, 2.2F, 0.3F};
  for (int i = 0; i < 100; ++i) low.points.emplace_back(0.005F * static_cast<float>(i), 2.2F, 0.0F);
  EXPECT_EQ(stateAt(gridOf(room(), {low}), 2.0, 2.2), OccupancyGrid::kUnknown);
}

TEST(OccupancyGrid, WhatCannotBeIsRefused) {
  EXPECT_THROW(GridMaker({}, {}), InputError);
  GridConfig config;
  config.cell_m = 0;
  EXPECT_THROW(GridMaker(room(), config), InputError);
  config = {};
  config.largest_m = 3;
  EXPECT_THROW(GridMaker(room(), config), InputError);
  SurfelArrays s = room();
  s.x[0] = s.y[1] = s.z[2] = s.radius[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(stateAt(gridOf(s, {}), 4.01, 1.0), OccupancyGrid::kOccupied);
}

TEST(GridFile, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  const OccupancyGrid grid = gridOf(room(), {strip()});
  for (const bool png : {false, true}) {
    saveGrid(folder / "map.yaml", grid, png);
    const OccupancyGrid read = loadGrid(folder / "map.yaml");
    EXPECT_EQ(cv::countNonZero(read.cells != grid.cells), 0);
    EXPECT_NEAR(read.low_x_m, grid.low_x_m, 1e-6);
    EXPECT_EQ(read.cell_m, grid.cell_m);
  }
  // The first row of the image is the largest y: there is the floor's end.
  EXPECT_EQ(readFile(folder / "map.pgm").substr(0, 3), "P5\n");
  EXPECT_THROW(saveGrid(folder / "map.txt", grid), InputError);
  EXPECT_THROW(saveGrid(folder / "none/map.yaml", grid), InputError);
  EXPECT_THROW(loadGrid(folder.write("bad.yaml", "resolution: 0.05\n")), InputError);
  EXPECT_THROW(
      loadGrid(folder.write("lost.yaml", "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")),
      InputError);
}

TEST(GridCheck, CountsWhatIsRight) {
  const OccupancyGrid grid = gridOf(room(), {strip()});
  const SurfelArrays s = room();
  std::vector<Vector3f> truth;
  for (std::size_t i = 0; i < s.size(); ++i) truth.emplace_back(s.x[i], s.y[i], s.z[i]);
  const Eigen::Isometry3d none = Eigen::Isometry3d::Identity();
  const GridScore score = checkGrid(grid, {}, none, truth);
  EXPECT_EQ(score.seen, grid.count(OccupancyGrid::kFree) + grid.count(OccupancyGrid::kOccupied));
  EXPECT_GT(score.share(), 0.94);  // rims of the table
  Eigen::Isometry3d shifted = none;
  shifted.translation().x() = 0.1;
  const GridScore off = checkGrid(grid, {}, shifted, truth);
  EXPECT_LT(off.share(), score.share());
  EXPECT_EQ(off.seen, off.right + off.false_free + off.false_occupied);
}

}  // namespace
}  // namespace pf

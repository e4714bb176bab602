// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/core/error.hpp"
#include "posefusion/grid/floor_plan.hpp"
#include "posefusion/mesh/surface_nets.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;

/// A column of 0.5 m radius around the origin.
TriangleMesh column() {
  return polygonise([](const Vector3f& p) { return p.head<2>().norm() - 0.5F; },
                    {Vector3f(-0.7F, -0.7F, 0), Vector3f(0.7F, 0.7F, 1)}, 0.05F);
}

OccupancyGrid smallGrid() {
  OccupancyGrid grid;
  grid.low_x_m = grid.low_y_m = -1;
  grid.cells = cv::Mat(40, 40, CV_8SC1, cv::Scalar(OccupancyGrid::kFree));
  grid.cells(cv::Rect(10, 10, 20, 20)) = OccupancyGrid::kOccupied;
  return grid;
}

TEST(FloorPlan, ACutIsOneClosedLineRoundTheColumn) {
  const std::vector<Outline> cut = cutLevel(column(), 0.52F);
  ASSERT_EQ(cut.size(), 1U);
  EXPECT_EQ(cut[0].front(), cut[0].back());
  double length = 0;
  for (std::size_t i = 1; i < cut[0].size(); ++i) {
    length += (cut[0][i] - cut[0][i - 1]).norm();
    EXPECT_NEAR(cut[0][i].norm(), 0.5, 0.01);
  }
  EXPECT_NEAR(length, M_PI, 0.03);
  EXPECT_TRUE(cutLevel(column(), 3).empty());
}

TEST(FloorPlan, IsAsLargeAsItsScaleSays) {
  PlanConfig config;
  config.title = "a < b & c";
  const std::string svg = floorPlan(smallGrid(), column(), config);
  // 2 m are 40 mm, with a margin of 10 mm.
  EXPECT_NE(svg.find("width=\"60.00mm\" height=\"76.00mm\""), std::string::npos) << svg;
  EXPECT_NE(svg.find("1 m, 1 : 50</text>"), std::string::npos) << svg;
  EXPECT_NE(svg.find("a &lt; b &amp; c</text>"), std::string::npos) << svg;
  config.scale = 100;
  EXPECT_NE(floorPlan(smallGrid(), column(), config).find("width=\"40.00mm\""), std::string::npos);
}

TEST(FloorPlan, WhatCannotBeIsRefused) {
  OccupancyGrid nothing = smallGrid();
  nothing.cells = OccupancyGrid::kUnknown;
  EXPECT_THROW(floorPlan(nothing, column(), {}), InputError);
  PlanConfig config;
  config.scale = 0;
  EXPECT_THROW(floorPlan(smallGrid(), column(), config), InputError);
}

}  // namespace
}  // namespace pf

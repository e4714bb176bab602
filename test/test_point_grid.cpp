// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/point_grid.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace pf {
namespace {

TEST(PointGrid, FindsAllPointsOfABox) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-0.4F, 0.4F);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2000; ++i) points.emplace_back(place(random), place(random), place(random));
  const PointGrid grid(points);
  for (int n = 0; n < 50; ++n) {
    Eigen::AlignedBox3f box(Eigen::Vector3f(place(random), place(random), place(random)));
    box.extend(Eigen::Vector3f(place(random), place(random), place(random)));
    std::set<std::size_t> found;
    grid.visit(box, [&](std::size_t i) { EXPECT_TRUE(found.insert(i).second) << "twice"; });
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_TRUE(!box.contains(points[i]) || found.count(i) == 1) << i;
    }
    EXPECT_LT(found.size(), points.size());
  }
}

TEST(PointGrid, OfNoPointsFindsNone) {
  const std::vector<Eigen::Vector3f> none;
  PointGrid(none).visit({Eigen::Vector3f(-1, -1, -1), Eigen::Vector3f(1, 1, 1)},
                        [](std::size_t) { ADD_FAILURE(); });
}

}  // namespace
}  // namespace pf

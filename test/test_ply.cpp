// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/ply.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

/// A map of three stable surfels.
void saveSmallMap(const std::string& path) {
  SurfelArrays s;
  s.forEachArray([](auto& array) { array.resize(3); });
  for (std::size_t i = 0; i < 3; ++i) {
    s.x[i] = static_cast<float>(i);
    s.z[i] = 2.5F;
    s.ny[i] = -1;
    s.r[i] = 200;
    s.b[i] = 10;
    s.odds[i] = static_odds::kMost;
  }
  SurfelMap map(MapConfig{}, 1000.0F);  // all in one block, so that their order stays
  map.add(s);
  saveMap(path, map);
}

TEST(Ply, ReadsAMapAndPassesOverWhatItDoesNotNeed) {
  TemporaryFolder folder;
  saveSmallMap(folder / "map.ply");
  const auto points = loadPoints(folder / "map.ply");
  ASSERT_EQ(points.size(), 3U);
  EXPECT_TRUE(points[2].position.isApprox(Eigen::Vector3f(2, 0, 2.5F)));
  EXPECT_TRUE(points[2].normal.isApprox(Eigen::Vector3f(0, -1, 0)));
  EXPECT_EQ(points[2].color[0], 200);
  EXPECT_EQ(points[2].color[1], 0);
  EXPECT_EQ(points[2].color[2], 10);
}

TEST(Ply, WrongInputIsAnErrorThatNamesTheFile) {
  TemporaryFolder folder;
  saveSmallMap(folder / "map.ply");
  const std::string whole = readFile(folder / "map.ply");
  const auto said = [&](const std::string& text) {
    return errorOf([&] { loadPoints(folder.write("p.ply", text)); });
  };
  EXPECT_NE(said("stl").find("p.ply: has no PLY"), std::string::npos);
  EXPECT_NE(said(whole.substr(0, whole.size() - 1)).find("not whole"), std::string::npos);
  EXPECT_NE(said(whole.substr(0, whole.find("end_header") + 10)).find("a header without an end"),
            std::string::npos);
  std::string other = whole;
  other.replace(other.find("red"), 3, "rot");
  EXPECT_NE(said(other).find("no property uchar red"), std::string::npos) << said(other);
  other = whole;
  other.replace(other.find("binary_little"), 13, "binary_bigger");
  EXPECT_NE(said(other).find("binary_bigger"), std::string::npos);
}

}  // namespace
}  // namespace pf

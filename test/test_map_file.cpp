// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/core/trajectory.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

/// Stable surfels, no two alike.
SurfelArrays surfelsOf(std::size_t count) {
  SurfelArrays surfels;
  float value = 0.0F;
  surfels.forEachArray([&](auto& array) {
    array.resize(count);
    for (auto& x : array) x = static_cast<std::decay_t<decltype(x)>>(value += 0.37F);
  });
  surfels.odds.assign(count, static_odds::kMost);
  return surfels;
}

/// All in one block, so that their order stays.
SurfelMap mapOf(const SurfelArrays& surfels) {
  SurfelMap map(MapConfig{}, 1000.0F);
  map.add(surfels);
  return map;
}

TEST(MapFile, LiesInTheRequestedFrame) {
  const TemporaryFolder folder;
  const SurfelArrays surfels = surfelsOf(9);
  saveMap(folder / "m.ply", mapOf(surfels), bodyFromOptical());
  const SurfelArrays read = loadMap(folder / "m.ply");
  ASSERT_EQ(read.size(), 9U);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read.x[i], surfels.z[i]) << "forward";
    EXPECT_EQ(read.y[i], -surfels.x[i]) << "left";
    EXPECT_EQ(read.z[i], -surfels.y[i]) << "up";
    EXPECT_EQ(read.nz[i], -surfels.ny[i]);
  }
}

TEST(MapFile, ReadsBackTheStableSurfels) {
  TemporaryFolder folder;
  SurfelArrays surfels = surfelsOf(10);
  surfels.odds[3] = 0.5F;
  surfels.r[4] = 300.0F;
  surfels.g[4] = -5.0F;
  EXPECT_EQ(saveMap(folder / "m.ply", mapOf(surfels)), 9U);
  const SurfelArrays read = loadMap(folder / "m.ply");
  ASSERT_EQ(read.size(), 9U);
  EXPECT_EQ(read.x[2], surfels.x[2]);
  EXPECT_EQ(read.x[3], surfels.x[4]) << "the unstable one is left out";
  EXPECT_EQ(read.nz[8], surfels.nz[9]);
  EXPECT_EQ(read.radius[8], surfels.radius[9]);
  EXPECT_NEAR(read.odds[8], static_odds::kMost, 1e-4);
  EXPECT_EQ(read.b[0], std::round(surfels.b[0]));
  EXPECT_EQ(read.r[3], 255.0F);
  EXPECT_EQ(read.g[3], 0.0F);
}

TEST(MapFile, IsPlyAsOtherToolsReadIt) {
  TemporaryFolder folder;
  saveMap(folder / "m.ply", mapOf(surfelsOf(2)));
  const std::string text = readFile(folder / "m.ply");
  const auto end = text.find("end_header\n");
  ASSERT_NE(end, std::string::npos);
  EXPECT_EQ(text.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0U);
  EXPECT_EQ(text.size() - end - 11, 2U * (6 * 4 + 3 + 2 * 4));
}

TEST(MapFile, DamagedFilesAreErrors) {
  TemporaryFolder folder;
  saveMap(folder / "m.ply", mapOf(surfelsOf(5)));
  const std::string text = readFile(folder / "m.ply");
  const auto error = [&](const std::string& content) {
    const auto path = folder.write("x.ply", content);
    return errorOf([&] { loadMap(path); });
  };
  EXPECT_NE(error(text.substr(0, text.size() - 1)).find("is not whole, expected 5 surfels"),
            std::string::npos);
  EXPECT_NE(error(text.substr(0, 50)).find("x.ply: is no map"), std::string::npos);
  EXPECT_NE(error("").find("x.ply: is no map"), std::string::npos);
}

}  // namespace
}  // namespace pf

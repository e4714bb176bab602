// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "posefusion/core/error.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/io/cloud_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/map/thinned.hpp"
#include "surfel_cloud.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

TEST(CloudFile, PlyIsAMapAndPcdHasTheSamePoints) {
  const TemporaryFolder folder;
  const SurfelArrays surfels = cloud(100, 2);
  saveCloud(folder / "a.ply", surfels);
  EXPECT_EQ(loadMap(folder / "a.ply").x, surfels.x);
  saveCloud(folder / "a.pcd", surfels);
  const std::string pcd = readFile(folder / "a.pcd");
  EXPECT_NE(pcd.find("\nPOINTS 100\nDATA binary\n"), std::string::npos);
  const std::size_t begin = pcd.size() - 100 * 28;
  EXPECT_EQ(pcd.substr(begin - 12, 12), "DATA binary\n");
  for (std::size_t i = 0; i < 100; ++i) {
    float x = 0;
    std::memcpy(&x, &pcd[begin + 28 * i], sizeof x);
    EXPECT_EQ(x, surfels.x[i]);
  }
  EXPECT_THROW(saveCloud(folder / "a.las", surfels), InputError);
  EXPECT_THROW(saveCloud(folder / "b.pcd", {}), InputError);
  EXPECT_THROW(saveCloud(folder / "none/b.pcd", surfels), InputError);
}

TEST(Thinned, OnePointInEachCubeAndInItsBounds) {
  SurfelArrays surfels = cloud(5000, 1);
  surfels.x[3] = std::numeric_limits<float>::quiet_NaN();
  constexpr float kVoxel_m = 0.25F;
  const SurfelArrays few = thinned(surfels, kVoxel_m);
  EXPECT_EQ(few.size(), 64U);
  std::set<std::tuple<long, long, long>> cubes;
  const auto cube = [&](float v) { return std::lround(std::floor(v / kVoxel_m)); };
  for (std::size_t i = 0; i < few.size(); ++i) {
    cubes.emplace(cube(few.x[i]), cube(few.y[i]), cube(few.z[i]));
    EXPECT_NEAR(std::hypot(few.nx[i], few.ny[i], few.nz[i]), 1, 1e-5);
  }
  EXPECT_EQ(cubes.size(), 64U);
  EXPECT_EQ(thinned(few, 1e-3F).x, few.x);  // what is alone stays as it is
}

}  // namespace
}  // namespace pf

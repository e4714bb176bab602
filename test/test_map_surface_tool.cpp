// SPDX-License-Identifier: BSD-3-Clause
// posefusion_map from the command line: surfaces and plans.
#include <gtest/gtest.h>

#include <filesystem>

#include "example_map.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/mesh_file.hpp"
#include "program.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

class MapSurfaceToolTest : public testing::Test {
 protected:
  MapSurfaceToolTest() { MapWriter(file, MapWriter::Mode::create).write(example.update); }

  int run(std::vector<std::string> arguments) {
    const Program program("posefusion_map", std::move(arguments), folder / "log.txt");
    const int code = program.exitCode();
    said = program.said();
    return code;
  }
  bool hasSaid(const std::string& text) const { return said.find(text) != std::string::npos; }

  /// A map file with these surfels alone.
  std::string mapWith(const SurfelArrays& surfels, const std::string& name) const {
    SurfelMap map{MapConfig{}};
    map.restore({{kFirstFragment, surfels}}, 9);
    MapUpdate update = example.update;
    update.block_count = static_cast<std::uint32_t>(map.blocks().size());
    update.blocks = changedBlocks(map, -1);
    return saved(folder, update, name);
  }

  const TemporaryFolder folder;
  const ExampleMap example;  // a wall of 2.4 x 1.5 m, 2 m before the camera
  const std::string file = folder / "map.pfdb";
  std::string said;
};

TEST_F(MapSurfaceToolTest, AMeshIsTheWallInTheFrameOfResults) {
  const std::string ply = folder / "mesh.ply";
  EXPECT_EQ(run({"mesh", file, "-o", ply}), 0) << said;
  EXPECT_TRUE(hasSaid("of 4000 surfels")) << said;
  const TriangleMesh mesh = loadMesh(ply);
  EXPECT_GT(mesh.triangles.size(), 5000U);
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    EXPECT_NEAR(mesh.positions[i].x(), 2.0F, 1e-4);  // x is ahead, z up
    EXPECT_LT(mesh.normals[i].x(), -0.99F);
  }
  EXPECT_EQ(run({"mesh", file, "-o", folder / "one.ply", "--threads", "1"}), 0) << said;
  EXPECT_TRUE(readFile(folder / "one.ply") == readFile(ply));
  EXPECT_EQ(run({"mesh", file, "-o", folder / "coarse.glb", "--cell", "0.05"}), 0) << said;
  EXPECT_LT(readFile(folder / "coarse.glb").size(), readFile(ply).size() / 3);
}

TEST_F(MapSurfaceToolTest, AMeshThatCannotBeIsRefusedAndNothingIsLeft) {
  const std::string out = folder / "mesh.ply";
  EXPECT_EQ(run({"mesh", mapWith({}, "empty.pfdb"), "-o", out}), 1);
  EXPECT_TRUE(hasSaid("0 stable surfels are too few")) << said;
  SurfelArrays one;
  example.map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    const auto index = static_cast<std::uint32_t>(i);
    if (one.size() == 0) one.append(s, &index, 1);
  });
  EXPECT_EQ(run({"mesh", mapWith(one, "one.pfdb"), "-o", out}), 1);
  EXPECT_TRUE(hasSaid("1 stable surfels are too few")) << said;
  EXPECT_EQ(run({"mesh", file, "-o", out, "--cell", "0"}), 1);
  EXPECT_TRUE(hasSaid("cell: is 0.000000, expected")) << said;
  EXPECT_EQ(run({"mesh", file, "-o", out, "--memory-limit", "1"}), 1);
  EXPECT_TRUE(hasSaid("expected at most 1 MB")) << said;
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_EQ(run({"mesh", file, "-o", folder / "mesh.stl"}), 1);
  EXPECT_TRUE(hasSaid("ends in '.stl', expected .ply, .obj or .glb")) << said;
  EXPECT_EQ(run({"mesh", file, "-o", folder / "none/mesh.ply"}), 1);
  EXPECT_TRUE(hasSaid("none/mesh.ply: cannot be written")) << said;
  EXPECT_NE(run({"mesh", file, "-o", out, "--method", "magic"}), 0);
  EXPECT_TRUE(hasSaid("magic")) << said;
}

TEST_F(MapSurfaceToolTest, APageLiesBesideTheMapByDefault) {
  EXPECT_EQ(run({"view", file}), 0) << said;
  EXPECT_TRUE(hasSaid("map.html: ")) << said;
  EXPECT_TRUE(hasSaid("of 4000 surfels in ")) << said;
  const std::string page = readFile(folder / "map.html");
  EXPECT_NE(page.find("<title>map.pfdb</title>"), std::string::npos);
  EXPECT_EQ(run({"view", file, "-o", folder / "b.html", "--surfels", "--title", "A room"}), 0)
      << said;
  EXPECT_TRUE(hasSaid("4000 surfels, of 4000")) << said;
  EXPECT_NE(readFile(folder / "b.html").find("<title>A room</title>"), std::string::npos);
}

TEST_F(MapSurfaceToolTest, APageThatCannotBeIsRefused) {
  const std::string out = folder / "a.html";
  EXPECT_EQ(run({"view", mapWith({}, "empty.pfdb"), "-o", out}), 1);
  EXPECT_TRUE(hasSaid("0 stable surfels are too few")) << said;
  EXPECT_EQ(run({"view", folder / "empty.pfdb", "-o", out, "--surfels"}), 1);
  EXPECT_TRUE(hasSaid("none of 0 stable surfels can be shown")) << said;
  EXPECT_EQ(run({"view", file, "-o", folder / "a.pdf"}), 1);
  EXPECT_TRUE(hasSaid("ends in '.pdf', expected .html")) << said;
  EXPECT_EQ(run({"view", file, "-o", folder / "none/a.html"}), 1);
  EXPECT_TRUE(hasSaid("none/a.html: cannot be written")) << said;
  EXPECT_EQ(run({"view", file, "-o", out, "--size-limit", "0"}), 1);
  EXPECT_TRUE(hasSaid("expected 0.1 to 500 MB")) << said;
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(MapSurfaceToolTest, AWallAloneHasNoFloorToStandOn) {
  EXPECT_EQ(run({"grid", file, "-o", folder / "grid.yaml"}), 1);
  EXPECT_TRUE(hasSaid(file + ": the map has no floor: 0 stable surfels face up")) << said;
  EXPECT_EQ(run({"plan", file, "-o", folder / "plan.svg"}), 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "plan.svg"));
  EXPECT_EQ(run({"grid", file, "-o", folder / "grid.txt"}), 1);
  EXPECT_TRUE(hasSaid("expected .yaml")) << said;
}

TEST_F(MapSurfaceToolTest, AFloorGivesGridAndPlan) {
  SurfelArrays floor;
  example.map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    const auto index = static_cast<std::uint32_t>(i);
    floor.append(s, &index, 1);
  });
  SurfelArrays wall = floor;  // y of the map is down, z ahead: the wall is where the floor ends
  for (std::size_t i = 0; i < floor.size(); ++i) {
    floor.z[i] = floor.y[i] + 1.3F;
    floor.y[i] = 0.8F;
    floor.nz[i] = 0;
    floor.ny[i] = -1;
  }
  wall.append(floor);
  const std::string map = mapWith(wall, "room.pfdb");
  EXPECT_EQ(run({"grid", map, "-o", folder / "grid.yaml"}), 0) << said;
  EXPECT_TRUE(hasSaid("the map leans by 0.0 degrees")) << said;
  EXPECT_TRUE(std::filesystem::exists(folder / "grid.pgm"));
  EXPECT_EQ(run({"plan", map, "-o", folder / "plan.svg", "--cut", "0.5"}), 0) << said;
  EXPECT_NE(readFile(folder / "plan.svg").find("</svg>"), std::string::npos);
}

TEST_F(MapSurfaceToolTest, CloudAndOctreeAreWritten) {
  EXPECT_EQ(run({"cloud", file, "-o", folder / "a.pcd", "--voxel", "0.1"}), 0) << said;
  EXPECT_TRUE(hasSaid(" points")) << said;
  EXPECT_EQ(run({"cloud", file, "-o", folder / "a.las"}), 1);
  EXPECT_TRUE(hasSaid("expected .pcd or .ply")) << said;
  EXPECT_EQ(run({"octomap", file, "-o", folder / "a.bt"}), 0) << said;
  EXPECT_EQ(readFile(folder / "a.bt").substr(0, 28), "# Octomap OcTree binary file");
  EXPECT_EQ(run({"octomap", file, "-o", folder / "a.ot"}), 1);
  EXPECT_EQ(run({"octomap", mapWith({}, "empty.pfdb"), "-o", folder / "b.bt"}), 1);
  EXPECT_TRUE(hasSaid("no stable surfels")) << said;
}

}  // namespace
}  // namespace pf

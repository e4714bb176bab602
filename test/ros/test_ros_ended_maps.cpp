// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/ended_maps.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "../temporary_folder.hpp"
#include "posefusion/io/files.hpp"

namespace posefusion_ros {
namespace {

namespace fs = std::filesystem;

class EndedMapsTest : public testing::Test {
 protected:
  /// A map was written, and ended.
  std::string end() {
    const pf::RunFolder run(folder.str());
    std::ofstream(run.file("map.ply")) << "a map";
    std::ofstream(run.file("map.pfdb")) << "a map to go on in";
    ended.add(run, {"map.ply", "map.pfdb", "trajectory.txt"});
    return run.path();
  }

  const pf::TemporaryFolder folder;
  EndedMaps ended;
};

TEST_F(EndedMapsTest, TheOldestGo) {
  const std::string first = end(), second = end(), third = end();
  ended.keep(2, "");
  EXPECT_FALSE(fs::exists(first));
  EXPECT_TRUE(fs::exists(second + "/map.ply"));
  EXPECT_TRUE(fs::exists(third + "/map.pfdb"));
}

TEST_F(EndedMapsTest, OtherFilesStay) {
  const std::string path = end();
  std::ofstream(path + "/notes.txt") << "the user's";
  std::ofstream(path + "/trajectory.txt") << "the user's too";
  ended.keep(0, "");
  EXPECT_FALSE(fs::exists(path + "/map.ply"));
  EXPECT_EQ(pf::readFile(path + "/notes.txt"), "the user's");
  EXPECT_EQ(pf::readFile(path + "/trajectory.txt"), "the user's too");
}

TEST_F(EndedMapsTest, AMapThatWasContinuedStaysWhole) {
  const std::string changed = end(), replaced = end();
  std::ofstream(changed + "/map.pfdb", std::ios::app) << ", longer";
  fs::remove(replaced + "/map.pfdb");
  std::ofstream(replaced + "/map.pfdb") << "a map to go on ex";
  ended.keep(0, "");
  for (const std::string& path : {changed, replaced}) {
    EXPECT_TRUE(fs::exists(path + "/map.pfdb")) << path;
    EXPECT_TRUE(fs::exists(path + "/map.ply")) << path;
  }
}

TEST_F(EndedMapsTest, TheMapInUseStaysAsLongAsItIs) {
  const std::string used = end(), second = end(), third = end();
  fs::create_directory_symlink(used, folder / "latest");
  const std::string file = realPath(folder / "latest/map.pfdb");
  ended.keep(1, file);
  EXPECT_TRUE(fs::exists(used + "/map.pfdb"));
  EXPECT_FALSE(fs::exists(second));
  EXPECT_FALSE(fs::exists(third));
  const std::string fourth = end();
  ended.keep(1, "");
  EXPECT_FALSE(fs::exists(used));
  EXPECT_TRUE(fs::exists(fourth));
}

}  // namespace
}  // namespace posefusion_ros

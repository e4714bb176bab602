// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/map_repair.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <random>

#include "example_map.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

class MapRepairTest : public testing::Test {
 protected:
  MapRepairTest() {
    // Three keyframes, so that one in the middle can be lost.
    MapUpdate& u = example.update;
    Keyframe third = u.keyframes[1];
    third.id = 2;
    third.T_map_camera.translation().x() += 0.3;
    u.keyframes.push_back(third);
    PoseConstraint step = u.constraints[0];
    step.from = 1;
    step.to = 2;
    u.constraints.push_back(step);
    KeyframeImages images = u.images[1];
    images.keyframe = 2;
    u.images.push_back(images);
    u.frames.push_back({2'000'000'000'000LL, {2, Eigen::Isometry3d::Identity()}});
    u.blobs["keyframe/1"] = "of the second";
    u.blobs["keyframe/2"] = "of the third";
    file = saved(folder, u);
  }

  /// The file after SQL that another program ran on it.
  std::string changed(const std::string& sql) const {
    const std::string path = folder.write("changed.pfdb", readFile(file));
    sqlite3* database = nullptr;
    EXPECT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sql;
    sqlite3_close(database);
    return path;
  }

  /// Repairs; the damaged file does not change, the new one is whole.
  MapRepair repair(const std::string& path) {
    fs::remove(repaired);
    const std::string before = readFile(path);
    const MapRepair result = repairMap(path, repaired);
    EXPECT_TRUE(readFile(path) == before);
    readAll(repaired);
    EXPECT_EQ(MapReader(repaired).missing(), "");
    return result;
  }

  const TemporaryFolder folder;
  ExampleMap example;
  std::string file;
  const std::string repaired = folder / "repaired.pfdb";
};

TEST_F(MapRepairTest, AWholeMapLosesNothing) {
  const MapRepair result = repair(file);
  EXPECT_TRUE(result.lost.empty()) << result.lost[0];
  EXPECT_EQ(result.kept.surfels, 4000U);
  EXPECT_EQ(result.keyframes, 3U);
  EXPECT_EQ(result.frames, 11U);
  const MapContent before = MapReader(file).content(), after = MapReader(repaired).content();
  EXPECT_EQ(after.blobs, before.blobs);
  EXPECT_EQ(after.settings, before.settings);
  EXPECT_EQ(after.constraints.size(), before.constraints.size());
  EXPECT_EQ(after.frame, before.frame);
}

TEST_F(MapRepairTest, ABlockThatIsDamagedIsLeftOut) {
  const std::string path = changed("UPDATE blocks SET surfels=zeroblob(120) WHERE id=1");
  EXPECT_NE(errorOf([&] { readAll(path); }), "");
  const MapRepair result = repair(path);
  ASSERT_EQ(result.lost.size(), 1U);
  EXPECT_NE(result.lost[0].find("1 blocks of surfels"), std::string::npos) << result.lost[0];
  const std::size_t lost = example.update.blocks[1].surfels->size();
  EXPECT_EQ(result.kept.surfels, 4000U - lost);
  EXPECT_EQ(surfelsIn(MapReader(repaired).surfels()), 4000U - lost);
}

TEST_F(MapRepairTest, WhatHangsOnALostKeyframeGoesAndItsNeighboursStayTied) {
  const MapRepair result = repair(changed("UPDATE keyframes SET t_map_camera=x'00' WHERE id=1"));
  EXPECT_EQ(result.keyframes, 2U);
  EXPECT_EQ(result.frames, 6U) << "five hung on the lost one";
  EXPECT_EQ(result.kept.images, 2U);
  const MapContent content = MapReader(repaired).content();
  EXPECT_EQ(content.blobs.at("keyframe/1"), "of the third") << "numbered anew";
  EXPECT_EQ(content.frames.back().pose.keyframe, 1);
  ASSERT_EQ(content.constraints.size(), 1U);
  const PoseConstraint& bridge = content.constraints[0];
  EXPECT_TRUE(bridge.T_from_to.isApprox(content.keyframes[0].T_map_camera.inverse() *
                                        content.keyframes[1].T_map_camera));
  EXPECT_GE(bridge.covariance(0, 0), 0.01);
}

TEST_F(MapRepairTest, TheLogOfAnotherMapIsLeftOut) {
  folder.write("map.pfdb-wal", std::string(100, 'x'));
  EXPECT_NE(errorOf([&] { readAll(file); }), "");
  const MapRepair result = repair(file);
  ASSERT_EQ(result.lost.size(), 1U);
  EXPECT_EQ(result.lost[0], "its log, which is of another map");
  EXPECT_EQ(result.kept.surfels, 4000U);
  EXPECT_TRUE(fs::exists(folder / "map.pfdb-wal")) << "it is the user's";
}

TEST_F(MapRepairTest, WhateverIsDamagedItGivesAWholeMapOrReportsWhyNot) {
  const std::string text = readFile(file);
  std::mt19937 random(7);
  int mended = 0;
  constexpr int kTimes = 100;
  for (int i = 0; i < kTimes; ++i) {
    std::string damaged = text;
    for (int k = 0; k < 20; ++k) {
      // Not the first page, without which there is no database.
      damaged[16384 + random() % (text.size() - 16384)] ^= static_cast<char>(1 << (random() % 8));
    }
    const std::string path = folder.write("damaged.pfdb", damaged);
    try {
      repair(path);
      ++mended;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(path + ": cannot be repaired: ", 0), 0U)
          << error.what();
    }
  }
  EXPECT_GT(mended, kTimes / 2);
  for (const auto& entry : fs::directory_iterator(folder.str())) {
    EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
  }
}

TEST_F(MapRepairTest, NothingIsWrittenOverOrMadeOfNothing) {
  folder.write("repaired.pfdb", "the user's");
  EXPECT_NE(errorOf([&] { repairMap(file, repaired); }).find("is there already"),
            std::string::npos);
  EXPECT_EQ(readFile(repaired), "the user's");
  const std::string other = folder.write("other.pfdb", "text");
  EXPECT_NE(errorOf([&] {
              repairMap(other, folder / "new.pfdb");
            }).find(other + ": cannot be repaired: "),
            std::string::npos);
  EXPECT_NE(errorOf([&] {
              repairMap(changed("DELETE FROM state"), folder / "new.pfdb");
            }).find("holds no map yet"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "new.pfdb"));
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/moving_objects_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

const std::string kFile = testing::TempDir() + "/moving_objects.json";

MovingObject object(int id, bool is_person) {
  MovingObject made;
  made.id = id;
  made.is_person = is_person;
  made.placeAt({{0, 0, 1}, {1, 2, 3}}, 0);
  made.velocity_m_s = {0.123456, 0, -1};
  if (is_person) made.joints_m[1] = {0.5F, 0.25F, 2};
  return made;
}

TEST(MovingObjectsFile, HoldsWhatMovesInEachFrame) {
  MovingObjectsFile file(kFile);
  file.add(1'033'333'333, {object(1, true), object(7, false)});
  file.add(1'066'666'666, {});
  file.add(1'100'000'000, {object(7, false)});
  EXPECT_FALSE(std::filesystem::exists(kFile)) << "not yet whole";
  file.finish();
  const auto root = nlohmann::json::parse(readFile(kFile));
  ASSERT_EQ(root["frames"].size(), 2U);
  EXPECT_EQ(root["joints"].size(), static_cast<std::size_t>(kJointCount));
  const auto& first = root["frames"][0];
  EXPECT_EQ(first["stamp"], "1.033333333");
  const auto& person = first["objects"][0];
  EXPECT_EQ(person["id"], 1);
  EXPECT_EQ(person["is_person"], true);
  EXPECT_EQ(person["centre"], (std::vector<double>{0.5, 1, 2}));
  EXPECT_EQ(person["box"], (std::vector<std::vector<double>>{{0, 0, 1}, {1, 2, 3}}));
  EXPECT_EQ(person["velocity"], (std::vector<double>{0.1235, 0, -1}));
  EXPECT_TRUE(person["joints"][0].is_null());
  EXPECT_EQ(person["joints"][1], (std::vector<double>{0.5, 0.25, 2}));
  EXPECT_FALSE(first["objects"][1].contains("joints"));
  EXPECT_EQ(root["frames"][1]["objects"][0]["id"], 7);
  std::filesystem::remove(kFile);
}

TEST(MovingObjectsFile, NothingThatMovesIsAFileToo) {
  MovingObjectsFile file(kFile);
  file.finish();
  EXPECT_TRUE(nlohmann::json::parse(readFile(kFile))["frames"].empty());
  std::filesystem::remove(kFile);
}

TEST(MovingObjectsFile, WithoutAFolderItIsAnError) {
  EXPECT_THROW(MovingObjectsFile("/nowhere/moving_objects.json"), InputError);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/complete_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "posefusion/io/files.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

TEST(CompleteFolder, IsThereWithAllThatWasWritten) {
  const TemporaryFolder folder;
  CompleteFolder results(folder / "output", "map");
  std::ofstream(results.file("map.ply")) << "a map";
  EXPECT_FALSE(fs::exists(folder / "output/map")) << "not before it is whole";
  EXPECT_EQ(results.finish(), folder / "output/map");
  EXPECT_EQ(readFile(folder / "output/map/map.ply"), "a map");
  EXPECT_FALSE(fs::exists(folder / "output/map.part"));
}

TEST(CompleteFolder, TakesTheNameOfNoOther) {
  const TemporaryFolder folder;
  folder.write("output/map/notes.txt", "the user's");
  CompleteFolder one(folder / "output", "map"), other(folder / "output", "map");
  std::ofstream(one.file("map.ply")) << "one";
  std::ofstream(other.file("map.ply")) << "other";
  const std::string of_other = other.finish(), of_one = one.finish();
  EXPECT_EQ(readFile(of_one + "/map.ply"), "one");
  EXPECT_EQ(readFile(of_other + "/map.ply"), "other");
  CompleteFolder later(folder / "output", "map");
  EXPECT_EQ(later.finish(), folder / "output/map_4");
  EXPECT_EQ(readFile(folder / "output/map/notes.txt"), "the user's");
  EXPECT_FALSE(fs::exists(folder / "output/map/map.ply"));
}

TEST(CompleteFolder, LeavesNothingWhereItWasNotFinished) {
  const TemporaryFolder folder;
  {
    const CompleteFolder results(folder / "output", "map");
    std::ofstream(results.file("map.ply")) << "half a m";
  }
  EXPECT_FALSE(fs::exists(folder / "output"));
}

TEST(CompleteFolder, WhatCannotBeMadeIsNamed) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "in the way");
  EXPECT_NE(errorOf([&] { CompleteFolder(file, "map"); }).find(file), std::string::npos);
  CompleteFolder results(folder.str(), "map");
  folder.write("map/in the way", "");
  EXPECT_NE(errorOf([&] { results.finish(); }).find(folder / "map"), std::string::npos);
}

}  // namespace
}  // namespace pf

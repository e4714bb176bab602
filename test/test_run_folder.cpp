// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/run_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

TEST(RunFolder, NoTwoRunsShareOne) {
  const TemporaryFolder folder;
  std::set<std::string> paths;
  for (int i = 0; i < 5; ++i) {
    const RunFolder run(folder / "output");
    EXPECT_TRUE(fs::is_empty(run.path())) << "the trial file is gone";
    EXPECT_TRUE(paths.insert(run.path()).second) << run.path();
  }
}

TEST(RunFolder, APartialOneGetsItsNameInOneStepAndTakesNoOthers) {
  const TemporaryFolder folder;
  RunFolder first(folder / "output", RunFolder::Name::partial);
  RunFolder second(folder / "output", RunFolder::Name::partial);
  EXPECT_NE(first.path(), second.path());
  for (RunFolder* run : {&first, &second}) {
    const std::string partial = run->path();
    EXPECT_EQ(fs::path(partial).extension(), ".partial");
    std::ofstream(run->file("map.ply")) << partial;
    run->finish();
    EXPECT_FALSE(fs::exists(partial));
    EXPECT_EQ(readFile(run->file("map.ply")), partial);
    run->finish();  // once more changes nothing
    EXPECT_EQ(readFile(run->file("map.ply")), partial);
  }
  EXPECT_NE(first.path(), second.path());
  // Another run has taken the name meanwhile.
  RunFolder third(folder / "output", RunFolder::Name::partial);
  const std::string wanted = fs::path(third.path()).replace_extension();
  fs::create_directory(wanted);
  std::ofstream(wanted + "/mine") << "another's";
  std::ofstream(third.file("map.ply")) << "a map";
  third.finish();
  EXPECT_EQ(third.path(), wanted + "_2");
  EXPECT_EQ(readFile(wanted + "/mine"), "another's");
}

TEST(RunFolder, WhatIsDiscardedLeavesNothing) {
  const TemporaryFolder folder;
  const RunFolder run(folder / "output", RunFolder::Name::partial, "_saved");
  EXPECT_NE(run.path().find("_saved.partial"), std::string::npos) << run.path();
  std::ofstream(run.file("map.ply")) << "half a map";
  run.discard();
  EXPECT_FALSE(fs::exists(folder / "output"));
}

TEST(RunFolder, LatestLeadsToTheLastRun) {
  const TemporaryFolder folder;
  for (const std::string text : {"first", "second"}) {
    const RunFolder run(folder / "output");
    std::ofstream(run.file("map.ply")) << text;
    run.makeLatest();
    EXPECT_EQ(readFile(folder / "output/latest/map.ply"), text);
    EXPECT_EQ(readFile(newestRun(folder / "output") + "/map.ply"), text);
    EXPECT_EQ(newestRun(run.path()), run.path()) << "one run itself";
  }
  fs::rename(folder / "output", folder / "moved");
  EXPECT_EQ(readFile(folder / "moved/latest/map.ply"), "second") << "the link is a relative one";
}

TEST(RunFolder, AFolderCalledLatestIsLeftAlone) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "latest");
  std::ofstream(folder / "latest/map.ply") << "the user's";
  RunFolder(folder.str()).makeLatest();
  EXPECT_EQ(readFile(folder / "latest/map.ply"), "the user's");
}

TEST(RunFolder, LeavesNothingWhereNothingWasWritten) {
  const TemporaryFolder folder;
  RunFolder(folder / "output").removeIfEmpty();
  EXPECT_FALSE(fs::exists(folder / "output"));
  const RunFolder run(folder / "output");
  std::ofstream(run.file("map.ply")) << "a map";
  run.removeIfEmpty();
  EXPECT_TRUE(fs::exists(run.file("map.ply")));
}

TEST(RunFolder, WhatCannotBeWrittenIsNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "in the way";
  for (const std::string& path : {folder / "file", folder / "file/below", std::string("/proc/x")}) {
    try {
      const RunFolder run(path);
      FAIL() << path;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
  }
}

TEST(RunFolder, LowSpaceIsReported) {
  const TemporaryFolder folder;
  const RunFolder run(folder / "output");
  EXPECT_EQ(run.lowSpace(0), "");
  const std::string said = run.lowSpace(1e15);
  EXPECT_NE(said.find(run.path()), std::string::npos) << said;
  EXPECT_NE(said.find("MB"), std::string::npos) << said;
}

}  // namespace
}  // namespace pf

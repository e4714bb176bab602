// SPDX-License-Identifier: BSD-3-Clause
// The log that lies beside a map file while it is written: lost, left over, or of another map.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "example_map.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_database.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

constexpr char kLog[] = "-wal";

/// Runs `write` in a process of its own that is killed then, without closing anything.
template <typename Write>
void killedAfter(const Write& write) {
  const pid_t child = fork();
  if (child == 0) {
    write();
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

/// A map whose writer was killed after two writes, so that there is a log.
std::string killed(const TemporaryFolder& folder, const std::string& name, ExampleMap example) {
  const std::string path = folder / name;
  killedAfter([&] {
    auto* const writer = new MapWriter(path, MapWriter::Mode::create);  // never closed
    writer->write(example.update);
    example.update.frames = {{2'000'000'000'000LL, {1, Eigen::Isometry3d::Identity()}}};
    example.update.frame = 10;
    writer->write(example.update);
  });
  return path;
}

TEST(MapLog, TheLogOfAnotherMapIsNotTakenIntoThisOne) {
  const TemporaryFolder folder;
  const std::string old = killed(folder, "old.pfdb", {});
  ASSERT_TRUE(fs::exists(old + kLog));
  ExampleMap other;
  other.update.settings = "of another map";
  const std::string path = saved(folder, other.update);
  const std::string whole = readFile(path);
  fs::copy_file(old + kLog, path + kLog);
  for (const auto& use : {+[](const std::string& p) { readAll(p); },
                          +[](const std::string& p) { MapWriter(p, MapWriter::Mode::extend); }}) {
    const std::string error = errorOf([&] { use(path); });
    EXPECT_NE(error.find(path + kLog + " beside it is not its own"), std::string::npos) << error;
    EXPECT_TRUE(readFile(path) == whole) << "nothing was changed";
  }
  fs::remove(path + kLog);
  EXPECT_EQ(MapReader(path).content().settings, "of another map");
}

TEST(MapLog, ANewMapTakesNothingFromTheCompanionsOfADeletedOne) {
  const TemporaryFolder folder;
  const std::string path = killed(folder, "map.pfdb", {});
  fs::remove(path);  // and the log stays
  ExampleMap other;
  other.update.settings = "of another map";
  saved(folder, other.update);
  EXPECT_EQ(MapReader(path).content().settings, "of another map");
  EXPECT_EQ(MapReader(path).missing(), "");
}

TEST(MapLog, AKilledWriterLeavesAllOfItWithTheLogAndNamesWhatIsMissingWithout) {
  const TemporaryFolder folder;
  const std::string path = killed(folder, "map.pfdb", {});
  EXPECT_EQ(MapReader(path).missing(), "");
  EXPECT_EQ(MapReader(path).content().frames.size(), 11U);
  // Copied without its log.
  const std::string copy = folder / "copy.pfdb";
  fs::copy_file(path, copy);
  const std::string missing = MapReader(copy).missing();
  EXPECT_NE(missing.find(copy + kLog + " is not there"), std::string::npos) << missing;
  // Only what the last write brought may be missing.
  EXPECT_GE(MapReader(copy).content().frames.size(), 10U);
}

TEST(MapLog, AClosedMapMissesNothingAlsoWhereTheHeaderWasNotWrittenAnyMore) {
  const TemporaryFolder folder;
  const std::string path = saved(folder, ExampleMap().update);
  EXPECT_EQ(MapReader(path).missing(), "");
  // As if killed between the end of the log and the change of the header that records it.
  std::string bytes = readFile(path);
  bytes[18] = bytes[19] = 2;
  EXPECT_EQ(MapReader(folder.write("header.pfdb", bytes)).missing(), "");
}

TEST(MapLog, GoingOnInAMapOpensItAgain) {
  const TemporaryFolder folder;
  const ExampleMap example;
  const std::string path = saved(folder, example.update);
  killedAfter([&] { (new MapWriter(path, MapWriter::Mode::extend))->write(example.update); });
  fs::remove(path + kLog);
  EXPECT_NE(MapReader(path).missing(), "");
  MapWriter(path, MapWriter::Mode::extend).write(example.update);
  EXPECT_EQ(MapReader(path).missing(), "");
}

TEST(MapLog, AMapIsRenamedWholeAndOverNothing) {
  const TemporaryFolder folder;
  const std::string path = saved(folder, ExampleMap().update, "new.pfdb");
  const auto rename = [&](const std::string& from, const std::string& to) {
    return errorOf([&] { renameMapFile(from, to); });
  };
  const std::string mine = folder.write("mine.pfdb", "text");
  EXPECT_NE(rename(path, mine).find(mine + " is there already"), std::string::npos);
  EXPECT_EQ(readFile(mine), "text");
  // A log alone would be taken for its own.
  folder.write("gone.pfdb-wal", "of a map that was deleted");
  EXPECT_NE(rename(path, folder / "gone.pfdb").find("is there already"), std::string::npos);
  // The program's own earlier one may go, but not for one that is not whole, nor under a log.
  const std::string open = killed(folder, "open.pfdb", {});
  const auto replace = [&](const std::string& from, const std::string& to) {
    return errorOf([&] { renameMapFile(from, to, IfThere::replace); });
  };
  const std::string own = saved(folder, ExampleMap().update, "own.pfdb"), before = readFile(own);
  EXPECT_NE(replace(open, own).find("was not closed"), std::string::npos);
  EXPECT_TRUE(readFile(own) == before);
  EXPECT_NE(replace(path, folder / "gone.pfdb").find("is there already"), std::string::npos);
  EXPECT_EQ(replace(saved(folder, ExampleMap().update, "later.pfdb"), own), "");
  readAll(own);
  EXPECT_NE(rename(open, folder / "map.pfdb").find("was not closed"), std::string::npos);
  EXPECT_TRUE(fs::exists(open));
  EXPECT_EQ(rename(path, folder / "map.pfdb"), "");
  readAll(folder / "map.pfdb");
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace
}  // namespace pf

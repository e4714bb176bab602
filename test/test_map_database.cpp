// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/map_database.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <random>
#include <thread>

#include "example_map.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

std::string saved(const TemporaryFolder& folder, const MapUpdate& update,
                  const std::string& name = "map.pfdb") {
  MapWriter(folder / name, MapWriter::Mode::create).write(update);
  return folder / name;
}

void readAll(const std::string& path) {
  const MapReader reader(path);
  const MapContent content = reader.content();
  reader.surfels();
  for (const Keyframe& k : content.keyframes) reader.images(k.id);
}

void expectEqual(const MapContent& a, const MapContent& b) {
  EXPECT_TRUE(a.camera == b.camera);
  EXPECT_EQ(a.settings, b.settings);
  EXPECT_EQ(a.brightness.gain, b.brightness.gain);
  EXPECT_EQ(a.brightness.offset, b.brightness.offset);
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.graph_version, b.graph_version);
  EXPECT_EQ(a.blobs, b.blobs);
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    EXPECT_EQ(a.keyframes[i].id, b.keyframes[i].id);
    EXPECT_EQ(a.keyframes[i].fragment, b.keyframes[i].fragment);
    EXPECT_EQ(a.keyframes[i].stamp_ns, b.keyframes[i].stamp_ns);
    EXPECT_EQ(a.keyframes[i].map_frame, b.keyframes[i].map_frame);
    EXPECT_EQ(a.keyframes[i].T_map_camera.matrix(), b.keyframes[i].T_map_camera.matrix());
  }
  ASSERT_EQ(a.constraints.size(), b.constraints.size());
  for (std::size_t i = 0; i < a.constraints.size(); ++i) {
    EXPECT_EQ(a.constraints[i].from, b.constraints[i].from);
    EXPECT_EQ(a.constraints[i].to, b.constraints[i].to);
    EXPECT_EQ(a.constraints[i].kind, b.constraints[i].kind);
    EXPECT_EQ(a.constraints[i].T_from_to.matrix(), b.constraints[i].T_from_to.matrix());
    EXPECT_EQ(a.constraints[i].covariance, b.constraints[i].covariance);
  }
  ASSERT_EQ(a.frames.size(), b.frames.size());
  for (std::size_t i = 0; i < a.frames.size(); ++i) {
    EXPECT_EQ(a.frames[i].stamp_ns, b.frames[i].stamp_ns);
    EXPECT_EQ(a.frames[i].pose.keyframe, b.frames[i].pose.keyframe);
    EXPECT_EQ(a.frames[i].pose.T_keyframe_camera.matrix(),
              b.frames[i].pose.T_keyframe_camera.matrix());
  }
}

void expectEqual(SurfelArrays a, const SurfelArrays& b) {
  a.forEachArray(b, [](const auto& x, const auto& y) { EXPECT_TRUE(x == y); });
}

/// Runs SQL on a file as another program would.
void change(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  char* error = nullptr;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
  sqlite3_close(database);
}

/// What is said of a map after such a change. Written once: waiting for the disk takes long.
std::string errorAfter(const std::string& sql) {
  const TemporaryFolder folder;
  static const std::string whole = readFile(saved(folder, ExampleMap().update));
  const std::string path = folder.write("changed.pfdb", whole);
  change(path, "PRAGMA synchronous=OFF; " + sql);
  const std::string error = errorOf([&] { readAll(path); });
  EXPECT_NE(error.find(path + ": "), std::string::npos) << sql << ": " << error;
  return error;
}

TEST(MapDatabase, GivesBackAllThatWasWritten) {
  const TemporaryFolder folder;
  const ExampleMap example;
  const std::string path = saved(folder, example.update);
  const MapReader reader(path);
  expectEqual(reader.content(), example.update);
  expectEqual(reader.surfels(), example.map.collect());
  const KeyframeImages images = reader.images(1);
  EXPECT_EQ(cv::norm(images.grey, example.update.images[1].grey, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(images.depth_mm, example.update.images[1].depth_mm, cv::NORM_INF), 0);
  EXPECT_TRUE(reader.images(7).grey.empty());
  const MapCounts counts = reader.counts();
  EXPECT_EQ(counts.surfels, 4000U);
  EXPECT_EQ(counts.blocks, example.map.blocks().size());
  EXPECT_EQ(counts.images, 2U);
  EXPECT_EQ(counts.bytes, fs::file_size(path));
}

TEST(MapDatabase, ARestoredMapHasTheSameSurfels) {
  const TemporaryFolder folder;
  const ExampleMap example;
  const MapReader reader(saved(folder, example.update));
  SurfelMap map((MapConfig()));
  map.restore(reader.surfels(), reader.content().frame);
  expectEqual(map.collect(), example.map.collect());
  EXPECT_EQ(map.frame(), 9);
}

TEST(MapDatabase, WritesAgainAndAgainWhatHasChanged) {
  const TemporaryFolder folder;
  ExampleMap example;
  MapUpdate& u = example.update;
  MapContent expected = u;
  {
    MapWriter writer(folder / "map.pfdb", MapWriter::Mode::create);
    writer.write(u);
    // A keyframe more, one moved, no loop, one more frame, one blob replaced, one block changed.
    example.map.advance();
    SurfelArrays one;
    one.resize(1);
    one.created[0] = one.seen[0] = 10;
    example.map.add(one);
    u.blocks = changedBlocks(example.map, 10);
    EXPECT_EQ(u.blocks.size(), 1U);
    u.block_count = static_cast<std::uint32_t>(example.map.blocks().size());
    u.frame = 10;
    u.keyframes.push_back(u.keyframes[1]);
    u.keyframes[2].id = 2;
    u.keyframes[0].T_map_camera.translation().x() += 1;
    u.constraints.pop_back();
    u.frames = {{5, {2, Eigen::Isometry3d::Identity()}}};
    u.blobs = {{"ferns", "new"}};
    u.images.clear();
    expected.keyframes = u.keyframes;
    expected.constraints = u.constraints;
    expected.frames.push_back(u.frames[0]);
    expected.blobs["ferns"] = "new";
    expected.frame = 10;
    writer.write(u);
  }
  const MapReader reader(folder / "map.pfdb");
  expectEqual(reader.content(), expected);
  expectEqual(reader.surfels(), example.map.collect());
  EXPECT_EQ(reader.counts().images, 2U);
}

TEST(MapDatabase, GoesOnInAFileOfBefore) {
  const TemporaryFolder folder;
  const ExampleMap example;
  MapUpdate u = example.update;
  const std::string path = saved(folder, u);
  u.frames.resize(1);
  u.keyframes[1].fragment = 0;
  u.block_count = 3;
  u.blocks.resize(3);
  MapWriter(path, MapWriter::Mode::extend).write(u);
  const MapReader reader(path);
  EXPECT_EQ(reader.content().frames.size(), 11U);
  EXPECT_EQ(reader.counts().blocks, 3U);
}

TEST(MapDatabase, IsOneFileWhenClosedAndDoesNotGrowByRewriting) {
  const TemporaryFolder folder;
  const ExampleMap example;
  {
    MapWriter writer(folder / "map.pfdb", MapWriter::Mode::create);
    for (int i = 0; i < 20; ++i) writer.write(example.update);
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.str()), fs::directory_iterator{}), 1);
  EXPECT_LT(fs::file_size(folder / "map.pfdb"), 3U * 4000 * SurfelArrays::bytesPerSurfel());
}

TEST(MapDatabase, ReadingDoesNotChangeAnything) {
  const TemporaryFolder folder;
  const std::string path = saved(folder, ExampleMap().update);
  const std::string before = readFile(path);
  readAll(path);
  EXPECT_TRUE(readFile(path) == before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.str()), fs::directory_iterator{}), 1);
}

TEST(MapDatabase, BelongsToOneProcessWhileItIsWritten) {
  const TemporaryFolder folder;
  const ExampleMap example;
  const std::string path = folder / "map.pfdb";
  {
    MapWriter writer(path, MapWriter::Mode::create);
    writer.write(example.update);
    const std::string in_use = path + ": is in use by another process";
    EXPECT_EQ(errorOf([&] { MapWriter(path, MapWriter::Mode::extend); }), in_use);
    EXPECT_EQ(errorOf([&] { MapReader{path}; }), in_use);
    writer.write(example.update);
  }
  readAll(path);
}

TEST(MapDatabase, DoesNotReplaceAFileOrMakeAFolder) {
  const TemporaryFolder folder;
  const std::string path = folder.write("mine.txt", "text");
  const auto create = [](const std::string& p) {
    return errorOf([&] { MapWriter(p, MapWriter::Mode::create); });
  };
  EXPECT_EQ(create(path), path + ": cannot be made: File exists");
  EXPECT_EQ(readFile(path), "text");
  EXPECT_EQ(create(folder / "no/map.pfdb"),
            folder / "no/map.pfdb" + ": cannot be made: No such file or directory");
  EXPECT_NE(errorOf([&] { MapWriter(folder / "none", MapWriter::Mode::extend); }), "");
  EXPECT_FALSE(fs::exists(folder / "none"));
}

TEST(MapDatabase, RefusesWhatIsNoMap) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    return errorOf([&] { readAll(folder.write("x", text)); });
  };
  const std::string no_map = folder / "x" + ": is no map of posefusion";
  EXPECT_EQ(error(""), no_map);
  EXPECT_EQ(error("ply\nformat binary_little_endian 1.0\n"), no_map);
  EXPECT_EQ(error(std::string(100000, 'x')), no_map);
  EXPECT_EQ(errorOf([&] { readAll(folder.str()); }),
            folder.str() + ": is a folder, expected a map file");
  EXPECT_NE(errorOf([&] { readAll(folder / "none"); }).find("cannot be opened"), std::string::npos);
  change(folder / "other", "CREATE TABLE state(id INTEGER PRIMARY KEY)");
  EXPECT_EQ(errorOf([&] { readAll(folder / "other"); }),
            folder / "other" + ": is no map of posefusion");
}

TEST(MapDatabase, RefusesWhatAMapCannotHold) {
  const auto said = [](const std::string& error, const std::string& text) {
    return error.find(text) != std::string::npos;
  };
  EXPECT_TRUE(said(errorAfter("PRAGMA user_version=2"), "a newer posefusion made it"));
  EXPECT_TRUE(said(errorAfter("CREATE TABLE more(x)"), "other tables"));
  EXPECT_TRUE(said(errorAfter("DROP TABLE blobs"), "other tables"));
  EXPECT_TRUE(
      said(errorAfter("DROP TABLE blocks; CREATE VIEW blocks AS SELECT 1 AS id"), "other tables"));
  EXPECT_TRUE(said(errorAfter("DELETE FROM state"), "holds no map yet"));
  EXPECT_TRUE(said(errorAfter("UPDATE state SET width=0"), "width"));
  EXPECT_TRUE(said(errorAfter("UPDATE state SET intrinsics='x'"), "the camera has 1 bytes"));
  EXPECT_TRUE(said(errorAfter("UPDATE state SET gain=1e999"), "brightness"));
  EXPECT_TRUE(said(errorAfter("UPDATE state SET frame=3"), "keyframe 1 is of frame 5"));
  EXPECT_TRUE(said(errorAfter("UPDATE state SET frame=1e15"), "number of frames"));
  EXPECT_TRUE(said(errorAfter("UPDATE blocks SET surfels=zeroblob(60) WHERE id=1"), "checksum"));
  EXPECT_TRUE(
      said(errorAfter("UPDATE keyframes SET t_map_camera=zeroblob(96)"), "no rigid motion"));
  EXPECT_TRUE(said(errorAfter("UPDATE keyframes SET id=9 WHERE id=1"), "its id is 9"));
  EXPECT_TRUE(said(errorAfter("DELETE FROM keyframes WHERE id=1"), "relative to keyframe 1"));
  EXPECT_TRUE(said(errorAfter("UPDATE constraints SET to_keyframe=5"), "constraint 0 -> 5"));
  EXPECT_TRUE(said(errorAfter("UPDATE constraints SET covariance=zeroblob(288)"), "covariance"));
  EXPECT_TRUE(said(errorAfter("UPDATE images SET grey=depth"), "an image of keyframe 0"));
  EXPECT_TRUE(said(errorAfter("UPDATE images SET depth=x'00'"), "an image of keyframe 0"));
}

TEST(MapDatabase, RefusesSurfelsThatCannotBe) {
  const TemporaryFolder folder;
  ExampleMap example;
  const auto error = [&](const std::string& name) {
    const std::string path = saved(folder, example.update, name);
    return errorOf([&] { readAll(path); });
  };
  SurfelArrays& s = example.update.blocks[0].surfels;
  s.nx[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(error("a").find("not finite"), std::string::npos);
  s.nx[3] = 0;
  s.created[0] = 10;
  EXPECT_NE(error("b").find("a surfel is of frame 10"), std::string::npos);
}

TEST(MapDatabase, ADamagedFileIsRefusedOrReadButNeverCrashes) {
  const TemporaryFolder folder;
  const std::string text = readFile(saved(folder, ExampleMap().update));
  std::mt19937 random(5);
  int refused = 0;
  for (int i = 0; i < 200; ++i) {
    std::string damaged = text;
    if (i % 4 == 0) {
      damaged.resize(random() % text.size());
    } else {
      for (int k = 0; k < (i % 4 == 1 ? 1 : 50); ++k) {
        // Every second one near the beginning, where the structure is.
        const std::size_t at = random() % (k % 2 == 0 ? text.size() : 40000);
        damaged[at] = static_cast<char>(damaged[at] ^ (1 << (random() % 8)));
      }
    }
    const std::string path = folder.write("damaged", damaged);
    try {
      readAll(path);
    } catch (const InputError& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).rfind(path + ": ", 0), 0U) << error.what();
    }
  }
  EXPECT_GT(refused, 120);
}

TEST(MapDatabase, AFullDiskLosesOnlyWhatDidNotFit) {
  const TemporaryFolder folder;
  ExampleMap example;
  const std::string path = folder / "map.pfdb";
  {
    MapWriter writer(path, MapWriter::Mode::create);
    writer.write(example.update);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, SIG_IGN);
    rlimit full = before;
    full.rlim_cur = 1'000'000;
    setrlimit(RLIMIT_FSIZE, &full);
    MapUpdate large = example.update;
    large.blobs["large"] = std::string(3'000'000, 'x');
    large.frame = 12;
    const std::string error = errorOf([&] { writer.write(large); });
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_NE(error.find(path + ": cannot be read or written"), std::string::npos) << error;
    example.update.frames.clear();
    example.update.frame = 11;
    writer.write(example.update);
  }
  EXPECT_EQ(MapReader(path).content().frame, 11);
  readAll(path);
}

/// Writes for ever, telling when the first is done.
[[noreturn]] void writeForEver(const std::string& path, int told) {
  ExampleMap example;
  MapWriter writer(path, MapWriter::Mode::create);
  for (;;) {
    writer.write(example.update);
    if (example.update.frame++ == 9 && write(told, "x", 1) != 1) _exit(1);
    example.update.frames.resize(1);
  }
}

TEST(MapDatabase, AKilledWriterLeavesAWholeMap) {
  std::mt19937 random(9);
  for (int i = 0; i < 12; ++i) {
    const TemporaryFolder folder;
    const std::string path = folder / "map.pfdb";
    int told[2];
    ASSERT_EQ(pipe(told), 0);
    const pid_t child = fork();
    if (child == 0) writeForEver(path, told[1]);
    char byte = 0;
    ASSERT_EQ(read(told[0], &byte, 1), 1);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 60000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(told[0]);
    close(told[1]);
    const std::string before = readFile(path);
    {
      const MapReader reader(path);
      const MapContent content = reader.content();
      EXPECT_EQ(static_cast<int>(content.frames.size()), content.frame + 1)
          << "the trajectory and the number of frames were written together";
      EXPECT_EQ(reader.surfels().size(), 4000U);
    }
    EXPECT_TRUE(readFile(path) == before);
    MapWriter(path, MapWriter::Mode::extend).write(ExampleMap().update);
    readAll(path);
  }
}

}  // namespace
}  // namespace pf

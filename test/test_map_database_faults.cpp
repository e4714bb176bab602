// SPDX-License-Identifier: BSD-3-Clause
// Map files that are no maps, are damaged, or whose writer had an accident.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <limits>
#include <random>
#include <thread>

#include "example_map.hpp"
#include "first_map_version.hpp"
#include "full_disk.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/map_database.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

/// The error of reading a map after such a change. Written once: waiting for the disk takes long.
std::string errorAfter(const std::string& sql) {
  const TemporaryFolder folder;
  static const std::string whole = readFile(saved(folder, ExampleMap().update));
  const std::string path = folder.write("changed.pfdb", whole);
  runSql(path, "PRAGMA synchronous=OFF; " + sql);
  const std::string error = errorOf([&] { readAll(path); });
  EXPECT_NE(error.find(path + ": "), std::string::npos) << sql << ": " << error;
  return error;
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
  runSql(folder / "other", "CREATE TABLE state(id INTEGER PRIMARY KEY)");
  EXPECT_EQ(errorOf([&] { readAll(folder / "other"); }),
            folder / "other" + ": is no map of posefusion");
}

TEST(MapDatabase, RefusesWhatAMapCannotHold) {
  const auto said = [](const std::string& error, const std::string& text) {
    return error.find(text) != std::string::npos;
  };
  EXPECT_TRUE(said(errorAfter("PRAGMA user_version=5"), "a newer posefusion made it"));
  EXPECT_TRUE(said(errorAfter("PRAGMA user_version=1"), "other tables")) << "those of the latest";
  EXPECT_TRUE(said(errorAfter("PRAGMA user_version=0"), "a map of version 0, expected 1 to 4"));
  EXPECT_TRUE(
      said(errorAfter("UPDATE blocks SET fragment=-1 WHERE id=2"), "block 2 is of fragment"));
  EXPECT_TRUE(said(errorAfter("UPDATE keyframes SET fragment=7 WHERE id=1"), "fragment is 7"));
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
  auto surfels = std::make_shared<SurfelArrays>(*example.update.blocks[0].surfels);
  example.update.blocks[0].surfels = surfels;
  SurfelArrays& s = *surfels;
  s.nx[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(error("a").find("not finite"), std::string::npos);
  s.nx[3] = 0;
  s.created[0] = 10;
  EXPECT_NE(error("b").find("a surfel is of frame 10"), std::string::npos);
  s.created[0] = 0;
  s.seen[0] = std::numeric_limits<std::int32_t>::min();
  EXPECT_NE(error("c").find("seen in -2147483648"), std::string::npos);
  s.seen[0] = 0;
  for (const float radius : {1e30F, 0.0F, -0.1F}) {
    s.radius[1] = radius;
    EXPECT_NE(error("d" + std::to_string(radius)).find("the radius of a surfel is"),
              std::string::npos)
        << radius;
  }
  s.radius[1] = 0.02F;
  s.nz[2] = 4;
  EXPECT_NE(error("e").find("the normal's length of a surfel is 4"), std::string::npos);
  s.nz[2] = -1;
  s.x[5] = 3e8F;
  EXPECT_NE(error("f").find("the place of a surfel"), std::string::npos);
  s.x[5] = 0;
  const float odds = s.odds[4];
  for (const float none : {-1e3F, 4.0F}) {
    s.odds[4] = none;
    EXPECT_NE(error("g" + std::to_string(none)).find("the odds of a surfel"), std::string::npos);
  }
  s.odds[4] = odds;
  EXPECT_EQ(error("whole"), "");
}

TEST(MapDatabase, ALargePictureIsRefusedBeforeItIsUnpacked) {
  // 30,000 x 30,000 pixels in some kilobytes would be unpacked to 900 MB.
  const TemporaryFolder folder;
  ExampleMap example;
  example.update.images[1].grey = cv::Mat::zeros(30, 33, CV_8UC1);
  const std::string path = saved(folder, example.update);
  EXPECT_NE(errorOf([&] {
              readAll(path);
            }).find("an image of keyframe 1 is damaged, or larger than the camera's"),
            std::string::npos);
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
    MapUpdate large = example.update;
    large.blobs["large"] = std::string(3'000'000, 'x');
    large.frame = 12;
    const std::string error = errorOf([&] {
      const FullDisk full(1'000'000);
      writer.write(large);
    });
    EXPECT_NE(error.find(path + ": cannot be read or written"), std::string::npos) << error;
    example.update.frames.clear();
    example.update.frame = 11;
    writer.write(example.update);
  }
  EXPECT_EQ(MapReader(path).content().frame, 11);
  readAll(path);
}

/// Writes until it is killed; sends a byte to `pipe_end` after the first writes. For a forked
/// process: the threads of TBB are not in it, and what waits for them waits for ever.
[[noreturn]] void writeUntilKilled(const std::string& path, ExampleMap& example, int pipe_end) {
  MapWriter writer(path, MapWriter::Mode::create);
  for (;;) {
    writer.write(example.update);
    if (example.update.frame++ == 9 && write(pipe_end, "x", 1) != 1) _exit(1);
    example.update.frames.resize(1);
  }
}

TEST(MapDatabase, AKilledWriterLeavesAWholeMap) {
  std::mt19937 random(9);
  for (int i = 0; i < 12; ++i) {
    const TemporaryFolder folder;
    const std::string path = folder / "map.pfdb";
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    ExampleMap example;
    const pid_t child = fork();
    if (child == 0) writeUntilKilled(path, example, pipe_ends[1]);
    close(pipe_ends[1]);  // a child that ends too soon ends the waiting too
    char byte = 0;
    ASSERT_EQ(read(pipe_ends[0], &byte, 1), 1);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 60000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(pipe_ends[0]);
    const std::string before = readFile(path);
    {
      const MapReader reader(path);
      const MapContent content = reader.content();
      EXPECT_EQ(static_cast<int>(content.frames.size()), content.frame + 1)
          << "the trajectory and the number of frames were written together";
      ASSERT_EQ(reader.surfels().size(), 1U);
      EXPECT_EQ(reader.surfels()[0].surfels.size(), 4000U);
    }
    EXPECT_TRUE(readFile(path) == before);
    MapWriter(path, MapWriter::Mode::extend).write(ExampleMap().update);
    readAll(path);
  }
}

}  // namespace
}  // namespace pf

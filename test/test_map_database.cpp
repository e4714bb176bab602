// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/map_database.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "example_map.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

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

void expectEqual(const std::vector<FragmentSurfels>& a, const std::vector<FragmentSurfels>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].fragment, b[i].fragment);
    SurfelArrays own = a[i].surfels;
    own.forEachArray(b[i].surfels, [](const auto& x, const auto& y) { EXPECT_TRUE(x == y); });
  }
}

TEST(MapDatabase, GivesBackAllThatWasWritten) {
  const TemporaryFolder folder;
  const ExampleMap example;
  const std::string path = saved(folder, example.update);
  const MapReader reader(path);
  expectEqual(reader.content(), example.update);
  expectEqual(reader.surfels(), example.map.parts());
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
  expectEqual(map.parts(), example.map.parts());
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
    one.nz[0] = -1;
    one.radius[0] = 0.02F;
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
  expectEqual(reader.surfels(), example.map.parts());
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

}  // namespace
}  // namespace pf

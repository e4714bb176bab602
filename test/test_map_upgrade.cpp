// SPDX-License-Identifier: BSD-3-Clause
// Map files of version 1, where fragment k lay at x = 500 m * k, and of those before the present.
#include <gtest/gtest.h>

#include "example_map.hpp"
#include "first_map_version.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

constexpr double kBetween_m = 500.0;

/// Keyframes of four frames: the first; one that begins fragment 1, and one tracked on from there;
/// and one tracked on from the first to beyond 250 m, where version 1 took it for fragment 1.
struct OldMap {
  MapUpdate update = ExampleMap().update;

  OldMap() {
    const std::vector<double> x = {0.1, kBetween_m, kBetween_m + 0.4, 251.0};
    update.keyframes.clear();
    update.constraints.clear();
    for (int i = 0; i < 4; ++i) {
      Keyframe k;
      k.id = i;
      k.fragment = i == 0 ? 0 : 1;
      k.stamp_ns = 100 + i;
      k.map_frame = 2 * i;
      k.T_map_camera.translation() << x[static_cast<std::size_t>(i)], 0.5, -0.25;
      update.keyframes.push_back(k);
    }
    track(1, 2);
    track(0, 3);
    update.frames = {{103, {2, Eigen::Isometry3d::Identity()}}};
    update.blocks.clear();
    for (int frame = 0; frame < 8; ++frame) addBlock(frame, x[static_cast<std::size_t>(frame / 2)]);
    update.block_count = static_cast<std::uint32_t>(update.blocks.size());
  }

  void track(int from, int to) {
    PoseConstraint step;
    step.kind = ConstraintKind::odometry;
    step.from = from;
    step.to = to;
    step.covariance = 1e-4 * Matrix6d::Identity();
    update.constraints.push_back(step);
  }

  /// One surfel, half a metre beside the camera.
  void addBlock(int frame, double x) {
    BlockRecord block;
    block.index = static_cast<std::uint32_t>(frame);
    SurfelArrays s;
    s.resize(1);
    s.nz[0] = -1;
    s.radius[0] = 0.01F;
    s.x[0] = static_cast<float>(x + 0.5);
    s.y[0] = 0.25F;
    s.created[0] = s.seen[0] = frame;
    block.surfels = std::make_shared<const SurfelArrays>(std::move(s));
    update.blocks.push_back(block);
  }

  std::string saved(const TemporaryFolder& folder) const {
    std::string path = pf::saved(folder, update, "old.pfdb");
    makeFirstVersion(path);
    return path;
  }
};

/// What a version 1 file should be read as.
void expectUpgraded(const MapReader& reader) {
  const std::vector<int> fragments = {0, 1, 1, 0};
  const std::vector<double> x = {0.1, 0.0, 0.4, 251.0};
  const auto keyframes = reader.content().keyframes;
  ASSERT_EQ(keyframes.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(keyframes[i].fragment, fragments[i]) << i;
    EXPECT_NEAR(keyframes[i].T_map_camera.translation().x(), x[i], 1e-12) << i;
    EXPECT_EQ(keyframes[i].T_map_camera.translation().y(), 0.5) << i;
  }
  std::size_t count = 0;
  for (const FragmentSurfels& part : reader.surfels()) {
    for (std::size_t i = 0; i < part.surfels.size(); ++i, ++count) {
      const auto keyframe = static_cast<std::size_t>(part.surfels.created[i] / 2);
      EXPECT_EQ(part.fragment, fragments[keyframe]) << part.surfels.created[i];
      EXPECT_NEAR(part.surfels.x[i], x[keyframe] + 0.5, 4e-5) << part.surfels.created[i];
      EXPECT_EQ(part.surfels.y[i], 0.25F);
    }
  }
  EXPECT_EQ(count, 8U);
}

TEST(MapUpgrade, AFileOfVersion1HasItsFragmentsApart) {
  const TemporaryFolder folder;
  const std::string path = OldMap().saved(folder), before = readFile(path);
  expectUpgraded(MapReader(path));
  EXPECT_TRUE(readFile(path) == before) << "reading changes nothing";
}

/// All that a file has, as the first write of one that goes on in it.
MapUpdate everythingIn(const MapReader& reader) {
  MapUpdate update;
  static_cast<MapContent&>(update) = reader.content();
  SurfelMap map((MapConfig()));
  map.restore(reader.surfels(), update.frame);
  update.blocks = changedBlocks(map, -1);
  update.block_count = static_cast<std::uint32_t>(map.blocks().size());
  update.frames.clear();
  return update;
}

TEST(MapUpgrade, AFileOfVersion1GoesOnAsOneOfTheLatest) {
  const TemporaryFolder folder;
  const std::string path = OldMap().saved(folder);
  const MapUpdate update = everythingIn(MapReader(path));
  { const MapWriter unused(path, MapWriter::Mode::extend); }
  expectUpgraded(MapReader(path));  // still whole: nothing was written
  MapWriter(path, MapWriter::Mode::extend).write(update);
  const MapReader reader(path);
  expectUpgraded(reader);
  EXPECT_EQ(reader.content().frames.size(), 1U) << "what was there stays";
  EXPECT_EQ(reader.counts().images, 2U);
  MapWriter(path, MapWriter::Mode::extend).write(update);
  expectUpgraded(MapReader(path));
}

TEST(MapUpgrade, AFileOfVersion2GoesOnAndHasRetiredKeyframesFromThenOn) {
  const TemporaryFolder folder;
  const std::string path = pf::saved(folder, ExampleMap().update, "old.pfdb");
  makeSecondVersion(path);
  const std::string before = readFile(path);
  MapUpdate update = everythingIn(MapReader(path));
  EXPECT_TRUE(readFile(path) == before) << "reading changes nothing";
  ASSERT_EQ(update.keyframes.size(), 2U);
  EXPECT_EQ(MapReader(path).counts().images, 2U);
  EXPECT_FALSE(update.keyframes[1].isRetired());
  update.keyframes[1].follows = 0;
  update.constraints.clear();
  MapWriter(path, MapWriter::Mode::extend).write(update);
  const MapReader reader(path);
  EXPECT_EQ(reader.content().keyframes[1].follows, 0);
  EXPECT_EQ(reader.counts().images, 1U) << "its pictures are gone";
  EXPECT_FALSE(reader.images(0).grey.empty());
}

TEST(MapUpgrade, SurfelsOfVersion3HaveOddsInPlaceOfFrames) {
  const TemporaryFolder folder;
  const ExampleMap example;
  const std::string path = pf::saved(folder, example.update, "old.pfdb");
  makeThirdVersion(path);
  const auto expectOdds = [&] {
    const SurfelArrays surfels = MapReader(path).surfels().front().surfels;
    ASSERT_EQ(surfels.size(), example.map.size());
    for (const float odds : surfels.odds) ASSERT_NEAR(odds, 20 * static_odds::kFrame, 1e-5);
  };
  expectOdds();
  const MapUpdate update = everythingIn(MapReader(path));
  MapWriter(path, MapWriter::Mode::extend).write(update);
  expectOdds();
  EXPECT_EQ(MapReader(path).counts().images, 2U);
}

TEST(MapUpgrade, WhatContradictedASurfelOfVersion3LowersItsOdds) {
  std::string bytes = thirdVersionOf(encode([] {
    SurfelArrays s;
    s.resize(3);
    for (float* value : {s.nz.data(), s.radius.data()}) std::fill(value, value + 3, 1.0F);
    s.odds = {static_odds::kMost, static_odds::kMost, static_odds::kNewcomer};
    return s;
  }()));
  const std::array<std::int32_t, 3> violations = {0, 10, 40};
  std::memcpy(bytes.data() + bytes.size() - sizeof violations, violations.data(),
              sizeof violations);
  const SurfelArrays read = decodeSurfels(bytes, 3, 0);
  EXPECT_FLOAT_EQ(read.odds[0], static_odds::kMost);
  EXPECT_NEAR(read.odds[1], 14 * static_odds::kFrame, 1e-5);
  EXPECT_EQ(read.odds[2], static_odds::kGone);
}

TEST(MapUpgrade, AFileOfVersion1WithOtherTablesIsRefused) {
  const TemporaryFolder folder;
  const std::string path = OldMap().saved(folder);
  runSql(path, "DROP TABLE blocks; CREATE TABLE blocks(id INTEGER PRIMARY KEY)");
  EXPECT_NE(errorOf([&] { readAll(path); }).find("other tables"), std::string::npos);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
// Maps of before, and what becomes of them: services and parameters of fusion.
#include <gtest/gtest.h>

#include <filesystem>

#include "loading_fixture.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/slam/pipeline.hpp"

namespace posefusion_ros {
namespace {

namespace fs = std::filesystem;

TEST_F(ChainLoading, AMapIsLoadedAndWhatItReplacesIsSaved) {
  ASSERT_TRUE(chain->load());
  for (int i = 0; i < 3; ++i) process(i);
  const auto loaded = loadMap("../map.pfdb");  // below the output
  ASSERT_TRUE(loaded.success) << loaded.message;
  EXPECT_NE(loaded.message.find(" 3 poses) in "), std::string::npos) << loaded.message;
  EXPECT_NE(loaded.message.find(map()), std::string::npos) << loaded.message;
  EXPECT_EQ(pf::loadTrajectory(folder / "out/latest/trajectory.txt").size(), 3U);
  EXPECT_EQ(pf::readSavedMap(folder / "out/latest/map.pfdb").frames.size(), 3U);
  const int next = find(3);
  ASSERT_GT(next, 0);
  EXPECT_GT(process(next).surfels, pf::surfelsIn(pf::readSavedMap(map()).surfels)) << "it grows";
  chain->unload();
  EXPECT_GT(pf::readSavedMap(folder / "out/latest/map.pfdb").frames.size(),
            pf::readSavedMap(map()).frames.size());
}

TEST_F(ChainLoading, AMapGoesOnAsInTheOfflineChainToTheBit) {
  chain->set("map_file", map());
  ASSERT_TRUE(chain->load());
  pf::Config config;
  config.pose.detector = "none";
  config.frame.shrink = 1;
  pf::Pipeline pipeline(config, pf::makePoseDetector(config.pose, {}));
  pipeline.load(pf::readSavedMap(map()), pf::MapUse::extend);
  for (int i = 0; i < 35; ++i) {
    const pf::FrameStatus expected = pipeline.process(frame(i)).status;
    EXPECT_EQ(outcome(process(i)), static_cast<int>(expected.outcome)) << i;
  }
  pipeline.finish();
  chain->unload();
  const pf::Trajectory trajectory = pipeline.mapper().backEnd().trajectory();
  ASSERT_GT(trajectory.size(), 5U);
  pf::saveTrajectory(folder / "expected.txt", pf::inWorld(pf::bodyFromOptical(), trajectory), "");
  pf::saveMap(folder / "expected.ply", pipeline.mapper().map(), pf::bodyFromOptical());
  EXPECT_EQ(posesIn(folder / "out/latest/trajectory.txt"), posesIn(folder / "expected.txt"));
  EXPECT_EQ(pf::readFile(folder / "out/latest/map.ply"), pf::readFile(folder / "expected.ply"));
}

TEST_F(ChainLoading, AMapStaysWhereItStoodInTheMapFrame) {
  const Eigen::Isometry3d T_world_map = Eigen::Translation3d(1, 2, 0.5) *
                                        Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                        pf::bodyFromOptical();
  const std::string placed = folder / "placed.pfdb";
  pf::Config config;
  config.pose.detector = "none";
  config.frame.shrink = 1;
  pf::Pipeline pipeline(config, pf::makePoseDetector(config.pose, {}));
  {
    pf::Mapper mapper(config);
    mapper.load(pf::readSavedMap(map()), pf::MapUse::extend);
    mapper.place(T_world_map);
    pf::MapRecording recording(placed, pf::MapWriter::Mode::create, "", mapper);
    recording.update(frame(0).camera, mapper);
    recording.finish(mapper);
  }
  pipeline.load(pf::readSavedMap(placed), pf::MapUse::extend);
  chain->set("map_file", placed);
  ASSERT_TRUE(chain->load());
  int located = 0;
  for (int i = 0; i < 35; ++i) {
    const pf::FrameStatus expected = pipeline.process(frame(i)).status;
    const TrackingStatusMsg status = process(i);
    if (!status.located) continue;
    ++located;
    const Eigen::Vector3d at = T_world_map * expected.T_map_camera.translation();
    EXPECT_NEAR(status.pose.position.x, at.x(), 1e-9) << i;
    EXPECT_NEAR(status.pose.position.y, at.y(), 1e-9) << i;
    EXPECT_NEAR(status.pose.position.z, at.z(), 1e-9) << i;
  }
  EXPECT_GT(located, 5);
  chain->unload();
  const pf::SavedMap after = pf::readSavedMap(folder / "out/latest/map.pfdb");
  ASSERT_TRUE(after.T_world_map);
  EXPECT_EQ(after.T_world_map->matrix(), T_world_map.matrix());
  pipeline.finish();
  pf::saveMap(folder / "expected.ply", pipeline.mapper().map(), T_world_map);
  EXPECT_EQ(pf::readFile(folder / "out/latest/map.ply"), pf::readFile(folder / "expected.ply"));
}

TEST_F(ChainLoading, ABadFileIsRefusedByItsNameAndNothingIsLost) {
  ASSERT_TRUE(chain->load());
  for (int i = 0; i < 3; ++i) process(i);
  const std::string other = folder / "other.pfdb";
  fs::copy(map(), other);
  pf::MapUpdate update;
  static_cast<pf::MapContent&>(update) = pf::MapReader(map()).content();
  update.frames.clear();
  update.block_count = static_cast<std::uint32_t>(pf::MapReader(map()).counts().blocks);
  update.camera.fx += 1;
  pf::MapWriter(other, pf::MapWriter::Mode::extend).write(update);
  const std::string cut = folder.write("cut.pfdb", pf::readFile(map()).substr(0, 30000));
  const std::string text = folder.write("text.pfdb", "no map");
  const auto refused = [&](const std::string& file, const std::string& why) {
    const auto response = loadMap(file);
    EXPECT_FALSE(response.success) << file;
    EXPECT_EQ(response.message.find(file + ": "), 0U) << response.message;
    EXPECT_NE(response.message.find(why), std::string::npos) << response.message;
  };
  refused(folder / "none.pfdb", "cannot be opened");
  refused(text, "is no map of posefusion");
  refused(cut, "");
  refused(other, "is a map of another camera");
  const auto status = process(3);
  EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED) << status.reason;
  chain->unload();
  EXPECT_EQ(pf::loadTrajectory(folder / "out/latest/trajectory.txt").size(), 4U);
}

TEST_F(ChainLoading, AMapThatCannotBeSavedIsNotReplaced) {
  ASSERT_TRUE(chain->load());
  process(0);
  const fs::path run = *fs::directory_iterator(folder / "out");
  fs::create_directories(run / "map.ply/in the way");
  EXPECT_FALSE(loadMap(map()).success);
  EXPECT_EQ(outcome(process(1)), TrackingStatusMsg::FUSED);
  fs::remove_all(run / "map.ply");
  chain->unload();
  EXPECT_EQ(pf::loadTrajectory(folder / "out/latest/trajectory.txt").size(), 2U);
}

TEST_F(ChainLoading, LocaliseOnlyChangesNothingEvenWhereTimeJumps) {
  chain->set("map_file", map());
  chain->set("localize_only", true);
  const std::string before = pf::readFile(map());
  ASSERT_TRUE(chain->load());
  later_ns = 100'000'000'000;
  for (int round = 0; round < 2; ++round) {
    int next = find(0);
    ASSERT_GT(next, 0) << round;
    const auto surfels = process(next).surfels;
    EXPECT_EQ(surfels, pf::surfelsIn(pf::readSavedMap(map()).surfels));
    for (int i = 0; i < 10; ++i) EXPECT_EQ(process(++next).surfels, surfels);
    later_ns = 0;
  }
  chain->unload();
  EXPECT_TRUE(pf::readFile(map()) == before);
  EXPECT_FALSE(fs::exists(folder / "out/latest/map.pfdb"));
  EXPECT_GT(pf::loadTrajectory(folder / "out/latest/trajectory.txt").size(), 10U);
}

TEST_F(ChainLoading, AMapGoesOnInItsOwnFile) {
  chain->set("map_file", map());
  chain->set("continue_map", true);
  const std::size_t frames = pf::readSavedMap(map()).frames.size();
  ASSERT_TRUE(chain->load());
  int next = find(0);
  ASSERT_GT(next, 0);
  ASSERT_TRUE(chain->call("save_map").success);
  process(next++);
  chain->unload();
  EXPECT_EQ(pf::readSavedMap(map()).frames.size(),
            frames + pf::loadTrajectory(folder / "out/latest/trajectory.txt").size());
  EXPECT_FALSE(fs::exists(folder / "out/latest/map.pfdb"));
}

TEST_F(ChainLoading, AMapOfAnotherCameraIsNamedInEachStatus) {
  chain->set("map_file", map());
  ASSERT_TRUE(chain->load());
  CameraMessages m = toMessages(emptyRoom().frame(0).frame);
  m.info->K[0] += 1;
  m.info->P[0] += 1;
  const auto status = chain->process(m);
  EXPECT_EQ(outcome(status), TrackingStatusMsg::BAD_INPUT);
  EXPECT_NE(status.reason.find(map() + ": is a map of another camera"), std::string::npos)
      << status.reason;
}

}  // namespace
}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
// Maps of before, and what becomes of them: services and parameters of fusion.
#include <gtest/gtest.h>
#include <posefusion/LoadMap.h>
#include <posefusion/SetMode.h>

#include <filesystem>
#include <optional>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/slam/pipeline.hpp"

namespace posefusion_ros {
namespace {

namespace fs = std::filesystem;
using posefusion::LoadMap;
using posefusion::SetMode;

/// A chain, and a map of the empty room that it may begin in.
class ChainLoading : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new pf::TemporaryFolder;
    pf::Config config;
    config.frame.shrink = 1;
    pf::Mapper mapper(config);
    for (int i = 0; i < 20; ++i) mapper.process({emptyRoom().frame(i).frame, {}, {}});
    pf::MapRecording recording(*made_ / "map.pfdb", pf::MapWriter::Mode::create, "", mapper);
    recording.update(emptyRoom().frame(0).frame.camera, mapper);
    recording.finish(mapper);
  }
  static void TearDownTestSuite() { delete made_; }

  void SetUp() override {
    fs::copy(*made_ / "map.pfdb", folder / "map.pfdb");
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    chain.emplace(std::string("loading_") + test->name());
    chain->set("frame/shrink", 1);
    chain->set("output", folder / "out");
  }

  std::string map() const { return folder / "map.pfdb"; }

  pf::RgbdFrame frame(int index) const {
    pf::RgbdFrame frame = emptyRoom().frame(index % 40).frame;
    frame.stamp_ns = 1'000'000'000LL + index * 33'333'333LL + later_ns;
    return frame;
  }
  TrackingStatusMsg process(int index) { return chain->process(toMessages(frame(index))); }

  /// Shows frames until the camera is found; the next one to show, or -1.
  int find(int index) {
    for (int end = index + 39; index < end; ++index) {
      if (process(index).state == TrackingStatusMsg::TRACKING) return index + 1;
    }
    return -1;
  }

  LoadMap::Response loadMap(const std::string& file) {
    return chain->call<LoadMap>("load_map", &LoadMap::Request::file, file);
  }
  SetMode::Response setMode(const std::string& mode) {
    return chain->call<SetMode>("set_mode", &SetMode::Request::mode, mode);
  }

  const pf::TemporaryFolder folder;
  std::optional<Chain> chain;
  std::int64_t later_ns = 0;

 private:
  static pf::TemporaryFolder* made_;
};
pf::TemporaryFolder* ChainLoading::made_ = nullptr;

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

TEST_F(ChainLoading, ParametersThatContradictLeaveTheNodeletIdle) {
  chain->set("localize_only", true);
  ASSERT_TRUE(chain->load({"fusion"}));
  EXPECT_FALSE(ros::service::exists(chain->space() + "/fusion/save_map", false));
  chain->unload();
  chain->set("map_file", folder / "none.pfdb");
  ASSERT_TRUE(chain->load({"fusion"}));
  EXPECT_FALSE(ros::service::exists(chain->space() + "/fusion/save_map", false));
}

TEST_F(ChainLoading, TheModeMayChangeAtAnyTime) {
  ASSERT_TRUE(chain->load());
  const auto early = setMode("localisation");
  EXPECT_FALSE(early.success);
  EXPECT_NE(early.message.find("nothing was mapped"), std::string::npos) << early.message;
  EXPECT_NE(setMode("fast").message.find(
                "mode 'fast', expected mapping or localisation (localization, localize_only)"),
            std::string::npos);
  process(0);
  const std::string names[] = {"localisation", "localization", "localize_only"};
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE(setMode(names[round]).success);
    const auto surfels = chain->statuses().back().surfels;
    for (int i = 1; i < 6; ++i) {
      const auto status = process(10 * round + i);
      EXPECT_EQ(status.state, TrackingStatusMsg::TRACKING);
      EXPECT_EQ(status.surfels, surfels);
    }
    ASSERT_TRUE(setMode("mapping").success);
    for (int i = 6; i < 11; ++i) process(10 * round + i);
    EXPECT_NE(chain->statuses().back().surfels, surfels);
  }
  ASSERT_TRUE(setMode("localisation").success);
  ASSERT_TRUE(chain->call("reset").success);
  EXPECT_GT(process(31).surfels, 0U) << "an empty map is to be filled";
}

TEST_F(ChainLoading, WhilePausedFramesAreReportedAndNotLookedAt) {
  ASSERT_TRUE(chain->load());
  EXPECT_EQ(outcome(process(0)), TrackingStatusMsg::FUSED);
  const auto surfels = chain->statuses().back().surfels;
  ASSERT_TRUE(chain->call("pause").success);
  for (int i = 1; i < 4; ++i) {
    const auto status = process(i);
    EXPECT_EQ(outcome(status), TrackingStatusMsg::PAUSED);
    EXPECT_EQ(status.surfels, surfels);
    EXPECT_EQ(status.located, 0);
  }
  ASSERT_TRUE(chain->call("resume").success);
  EXPECT_EQ(outcome(process(4)), TrackingStatusMsg::FUSED);
}

}  // namespace
}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a map: saved, emptied, begun anew.
#include <gtest/gtest.h>
#include <posefusion/GetMap.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion_ros/surfel_cloud.hpp"

namespace posefusion_ros {
namespace {

/// A chain that saves, and a camera in an empty room.
class ChainSaving : public testing::Test {
 protected:
  void load(const std::string& space, const std::string& output) {
    chain.emplace(space);
    chain->set("output", output);
    ASSERT_TRUE(chain->load());
  }

  /// Sends a frame of the room and waits for its status.
  TrackingStatusMsg process(int index, std::int64_t later_s = 0) {
    pf::RgbdFrame frame = emptyRoom().frame(index).frame;
    frame.stamp_ns += later_s * 1000000000L;
    return chain->process(toMessages(frame));
  }

  /// Plays three frames, then three that are 50 s earlier; all of them are to be fused.
  void playWithAJumpBack() {
    for (const int later_s : {100, 50}) {
      for (int i = 0; i < 3; ++i) {
        const auto status = process(i, later_s);
        EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED)
            << later_s << " " << i << status.reason;
        EXPECT_EQ(toNs(status.header.stamp), emptyRoom().stamp(i) + later_s * 1000000000L);
      }
    }
  }

  /// The folders of the runs in order, besides the link to the latest.
  std::vector<std::string> runs(const std::string& output = "out") const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder / output)) {
      if (!entry.is_symlink()) found.push_back(entry.path().string());
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  static std::size_t posesOf(const std::string& file) { return pf::loadTrajectory(file).size(); }

  const pf::TemporaryFolder folder;
  std::optional<Chain> chain;
};

TEST_F(ChainSaving, ResetKeepsTheMapAndSaveTellsWhere) {
  load("services", folder / "out");
  std::uint64_t grown = 0;
  for (int i = 0; i < 3; ++i) grown = process(i).surfels;
  EXPECT_GT(grown, 0U);
  const auto saved = chain->call("save_map");
  EXPECT_TRUE(saved.success);
  EXPECT_NE(saved.message.find(runs().front()), std::string::npos) << saved.message;
  process(3);
  const auto kept = chain->call("reset");
  EXPECT_TRUE(kept.success);
  EXPECT_NE(kept.message.find("(4 poses) in " + runs().front()), std::string::npos) << kept.message;
  EXPECT_TRUE(chain->call("reset").success);
  const auto again = process(4);
  EXPECT_EQ(outcome(again), TrackingStatusMsg::FUSED);
  EXPECT_NEAR(again.pose.position.x, 0, 1e-9) << "a new map begins";
  chain->unload();
  ASSERT_EQ(runs().size(), 2U) << "a folder for each map";
  EXPECT_EQ(posesOf(runs()[0] + "/trajectory.txt"), 4U);
  EXPECT_TRUE(std::filesystem::exists(runs()[0] + "/map.ply"));
  EXPECT_EQ(posesOf(runs()[1] + "/trajectory.txt"), 1U) << "saved at the end";
  EXPECT_EQ(posesOf(folder / "out/latest/trajectory.txt"), 1U);
}

TEST_F(ChainSaving, SavingNothingIsNoSuccessAndLeavesNothing) {
  load("nothing", folder / "out");
  process(0);
  ASSERT_TRUE(chain->call("reset").success);
  const std::string map = pf::readFile(folder / "out/latest/map.ply");
  const auto empty = chain->call("save_map");
  EXPECT_FALSE(empty.success);
  EXPECT_NE(empty.message.find("nothing to save"), std::string::npos);
  chain->unload();
  EXPECT_EQ(runs().size(), 1U);
  EXPECT_EQ(pf::readFile(folder / "out/latest/map.ply"), map);
}

TEST_F(ChainSaving, ASecondSessionWritesOverNothingOfTheFirst) {
  for (const int frames : {3, 1}) {
    load("session_" + std::to_string(frames), folder / "out");
    for (int i = 0; i < frames; ++i) process(i);
    chain->unload();
    chain.reset();
  }
  ASSERT_EQ(runs().size(), 2U);
  EXPECT_EQ(posesOf(runs()[0] + "/trajectory.txt"), 3U);
  EXPECT_EQ(posesOf(runs()[1] + "/trajectory.txt"), 1U);
}

TEST_F(ChainSaving, OnRequestOnlyNothingIsWrittenUnasked) {
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::current_path(folder.str());
  load("on_request", "");
  process(0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.str()));
  EXPECT_TRUE(chain->call("save_map").success);
  ASSERT_TRUE(chain->call("reset").success);
  process(1);
  process(2);
  EXPECT_TRUE(chain->call("save_map").success);
  chain->unload();
  std::filesystem::current_path(here);
  ASSERT_EQ(runs("posefusion_output").size(), 2U);
  EXPECT_EQ(posesOf(runs("posefusion_output")[0] + "/trajectory.txt"), 1U);
}

TEST_F(ChainSaving, FilesLieInTheMapFrameOfTf) {
  load("overlay", folder / "out");
  std::vector<TrackingStatusMsg> told;
  for (int i = 0; i < 12; ++i) told.push_back(process(i));
  posefusion::GetMap query;
  ASSERT_TRUE(ros::service::call(chain->space() + "/fusion/get_map", query));
  chain->unload();
  const pf::Trajectory poses = pf::loadTrajectory(folder / "out/latest/trajectory.txt");
  ASSERT_EQ(poses.size(), told.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto& saved = poses[i].T_world_camera.translation();
    EXPECT_NEAR(saved.x(), told[i].pose.position.x, 1e-6) << i;
    EXPECT_NEAR(saved.y(), told[i].pose.position.y, 1e-6) << i;
    EXPECT_NEAR(saved.z(), told[i].pose.position.z, 1e-6) << i;
  }
  const pf::SurfelArrays map = pf::loadMap(folder / "out/latest/map.ply");
  const SurfelPoint* shown = surfelsOf(query.response.cloud);
  ASSERT_NE(shown, nullptr);
  ASSERT_EQ(map.size(), query.response.cloud.width);
  for (std::size_t i = 0; i < map.size(); ++i) {
    ASSERT_NEAR(map.x[i], shown[i].x, 1e-5F);
    ASSERT_NEAR(map.z[i], shown[i].z, 1e-5F);
    ASSERT_NEAR(map.nz[i], shown[i].normal_z, 1e-5F);
  }
}

TEST_F(ChainSaving, AnOutputThatCannotBeWrittenEndsTheStart) {
  std::ofstream(folder / "file") << "in the way";
  chain.emplace("unwritable");
  chain->set("output", folder / "file");
  chain->load(Chain::nodelets());
  EXPECT_FALSE(ros::service::exists("/unwritable/fusion/save_map", false));
  chain->unload();
}

TEST_F(ChainSaving, AFailedSaveIsAnAnswerAndResetKeepsTheMap) {
  load("failing", folder / "out");
  process(0);
  std::filesystem::create_directories(runs().front() + "/map.ply/in the way");
  for (const std::string service : {"save_map", "reset"}) {
    const auto response = chain->call(service);
    EXPECT_FALSE(response.success);
    EXPECT_NE(response.message.find(runs().front() + "/map.ply"), std::string::npos)
        << response.message;
  }
  EXPECT_EQ(outcome(process(1)), TrackingStatusMsg::FUSED);
  std::filesystem::remove_all(runs().front() + "/map.ply");
  chain->unload();
  EXPECT_EQ(posesOf(folder / "out/latest/trajectory.txt"), 2U) << "nothing was emptied";
}

TEST_F(ChainSaving, ATimeJumpBeginsANewMapAndKeepsTheOldOne) {
  load("jump", folder / "out");
  playWithAJumpBack();
  ASSERT_TRUE(chain->call("save_map").success);
  ASSERT_EQ(runs().size(), 2U);
  EXPECT_EQ(posesIn(runs()[0] + "/trajectory.txt").substr(0, 5), "1100.");
  EXPECT_EQ(posesIn(runs()[1] + "/trajectory.txt").substr(0, 5), "1050.");
  chain->unload();
}

TEST_F(ChainSaving, OfMapsEndedUnaskedANumberIsKept) {
  chain.emplace("kept");
  chain->set("output", folder / "out");
  chain->set("maps_kept", 2);
  ASSERT_TRUE(chain->load());
  for (const int later_s : {90, 80, 70, 60, 50}) {
    EXPECT_EQ(outcome(process(0, later_s)), TrackingStatusMsg::FUSED);
  }
  chain->unload();
  ASSERT_EQ(runs().size(), 3U) << "two, and the one that was saved at the end";
  std::set<std::string> begins;
  for (const auto& run : runs()) begins.insert(posesIn(run + "/trajectory.txt").substr(0, 5));
  EXPECT_EQ(begins, (std::set<std::string>{"1070.", "1060.", "1050."}));
}

TEST_F(ChainSaving, ATimeJumpBeginsANewMapEvenWhereTheOldOneCannotBeKept) {
  load("jump_unsaved", folder / "out");
  std::filesystem::create_directories(runs().front() + "/map.ply/in the way");
  playWithAJumpBack();
  chain->unload();
  ASSERT_EQ(runs().size(), 2U);
  EXPECT_EQ(posesIn(runs()[1] + "/trajectory.txt").substr(0, 5), "1050.");
  EXPECT_EQ(posesIn(runs()[0] + "/trajectory.partial.txt").substr(0, 5), "1100.")
      << "at least the poses of the old map are kept";
}

TEST_F(ChainSaving, PosesAreOnTheDiskAsTheyComeAndTheMapNowAndThen) {
  chain.emplace("journal");
  chain->set("output", folder / "out");
  chain->set("save_period_s", 1e-3);
  ASSERT_TRUE(chain->load());
  for (int i = 0; i < 3; ++i) {
    process(i);
    EXPECT_EQ(posesOf(runs().front() + "/trajectory.partial.txt"), i + 1U);
  }
  EXPECT_TRUE(
      Chain::waitUntil([&] { return std::filesystem::exists(folder / "out/latest/map.ply"); }));
  chain->unload();
  EXPECT_EQ(posesOf(folder / "out/latest/trajectory.txt"), 3U);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/latest/trajectory.partial.txt"));
}

}  // namespace
}  // namespace posefusion_ros

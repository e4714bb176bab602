// SPDX-License-Identifier: BSD-3-Clause
// Maps that are saved, emptied and begun again.
#include <gtest/gtest.h>
#include <posefusion/GetMap.h>

#include <filesystem>
#include <fstream>

#include "../full_disk.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion_ros/surfel_cloud.hpp"
#include "saving_fixture.hpp"

namespace posefusion_ros {
namespace {

TEST_F(ChainSaving, ResetKeepsTheMapAndSaveReportsWhere) {
  load("services", folder / "out");
  std::uint64_t grown = 0;
  for (int i = 0; i < 3; ++i) grown = process(i).surfels;
  EXPECT_GT(grown, 0U);
  const auto saved = chain->call("save_map");
  EXPECT_TRUE(saved.success);
  ASSERT_EQ(saves().size(), 1U);
  EXPECT_NE(saved.message.find(saves().front()), std::string::npos) << saved.message;
  EXPECT_EQ(posesOf(folder / "out/latest/trajectory.txt"), 3U);
  process(3);
  const auto kept = chain->call("reset");
  EXPECT_TRUE(kept.success);
  EXPECT_NE(kept.message.find(" 4 poses) in " + runs().front()), std::string::npos) << kept.message;
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
  EXPECT_TRUE(folders("posefusion_output", false).empty());
  const auto saved = folders("posefusion_output", true);
  ASSERT_EQ(saved.size(), 2U);
  EXPECT_EQ(posesOf(saved[0] + "/trajectory.txt"), 1U);
  EXPECT_EQ(posesOf(saved[1] + "/trajectory.txt"), 2U);
  EXPECT_EQ(pf::readSavedMap(saved[1] + "/map.pfdb").frames.size(), 2U);
}

TEST_F(ChainSaving, FilesLieInTheMapFrameOfTf) {
  load("overlay", folder / "out");
  std::vector<TrackingStatusMsg> statuses;
  for (int i = 0; i < 12; ++i) statuses.push_back(process(i));
  posefusion::GetMap query;
  ASSERT_TRUE(ros::service::call(chain->space() + "/fusion/get_map", query));
  chain->unload();
  const pf::Trajectory poses = pf::loadTrajectory(folder / "out/latest/trajectory.txt");
  ASSERT_EQ(poses.size(), statuses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto& saved = poses[i].T_world_camera.translation();
    EXPECT_NEAR(saved.x(), statuses[i].pose.position.x, 1e-6) << i;
    EXPECT_NEAR(saved.y(), statuses[i].pose.position.y, 1e-6) << i;
    EXPECT_NEAR(saved.z(), statuses[i].pose.position.z, 1e-6) << i;
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

TEST_F(ChainSaving, WhatWasSavedOnRequestStays) {
  chain.emplace("asked_for");
  chain->set("output", folder / "out");
  chain->set("maps_kept", 2);
  ASSERT_TRUE(chain->load());
  for (int i = 0; i < 2; ++i) process(i);
  ASSERT_TRUE(chain->call("save_map").success);
  process(2);
  ASSERT_TRUE(chain->call("save_map").success);
  const std::vector<std::string> saved = saves();
  ASSERT_EQ(saved.size(), 2U) << "of one map";
  std::ofstream(runs().front() + "/notes.txt") << "the user's";
  const std::string notes = runs().front() + "/notes.txt";
  std::vector<std::string> bytes;
  for (const auto& path : saved) bytes.push_back(pf::readFile(path + "/map.pfdb"));
  for (int i = 3; i < 10; ++i) {
    ASSERT_TRUE(chain->call("reset").success);
    EXPECT_EQ(outcome(process(i)), TrackingStatusMsg::FUSED);
  }
  chain->unload();
  EXPECT_EQ(saves(), saved);
  for (std::size_t i = 0; i < saved.size(); ++i) {
    EXPECT_TRUE(pf::readFile(saved[i] + "/map.pfdb") == bytes[i]);
    EXPECT_EQ(pf::readSavedMap(saved[i] + "/map.pfdb").frames.size(), 2 + i);
    EXPECT_EQ(posesOf(saved[i] + "/trajectory.txt"), 2 + i);
    EXPECT_TRUE(std::filesystem::exists(saved[i] + "/map.ply"));
  }
  EXPECT_EQ(pf::readFile(notes), "the user's");
  EXPECT_EQ(runs().size(), 4U) << "two, that of the notes, and the one that was saved at the end";
}

TEST_F(ChainSaving, WhereTheDiskIsFullASaveIsRefusedAndLeavesNothing) {
  load("disk_full", folder / "out");
  for (int i = 0; i < 3; ++i) process(i);
  std_srvs::TriggerResponse refused;
  {
    const pf::FullDisk full(20'000);
    refused = chain->call("save_map");
  }
  EXPECT_FALSE(refused.success);
  EXPECT_NE(refused.message.find(folder / "out/"), std::string::npos) << refused.message;
  EXPECT_TRUE(saves().empty()) << saves().front();
  const auto saved = chain->call("save_map");
  EXPECT_TRUE(saved.success) << saved.message;
  EXPECT_EQ(saves().size(), 1U);
}

TEST_F(ChainSaving, WhereItCannotBeSavedResetKeepsTheMap) {
  load("failing", folder / "out");
  process(0);
  std::filesystem::create_directories(runs().front() + "/map.ply/in the way");
  const auto response = chain->call("reset");
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find(runs().front() + "/map.ply"), std::string::npos)
      << response.message;
  EXPECT_EQ(outcome(process(1)), TrackingStatusMsg::FUSED);
  std::filesystem::remove_all(runs().front() + "/map.ply");
  chain->unload();
  EXPECT_EQ(posesOf(folder / "out/latest/trajectory.txt"), 2U) << "nothing was emptied";
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

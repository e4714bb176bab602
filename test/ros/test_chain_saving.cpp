// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a map: saved, emptied, begun anew.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/io/trajectory_file.hpp"

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

  const pf::TemporaryFolder folder;
  std::optional<Chain> chain;
};

TEST_F(ChainSaving, ResetEmptiesTheMapAndSaveTellsWhere) {
  load("services", folder / "out");
  const auto empty = chain->call("save_map");
  EXPECT_TRUE(empty.success);
  EXPECT_NE(empty.message.find("nothing to save"), std::string::npos);
  std::uint64_t grown = 0;
  for (int i = 0; i < 3; ++i) grown = process(i).surfels;
  EXPECT_GT(grown, 0U);
  const auto saved = chain->call("save_map");
  EXPECT_TRUE(saved.success);
  EXPECT_NE(saved.message.find(folder / "out"), std::string::npos) << saved.message;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/map.ply"));
  EXPECT_TRUE(chain->call("reset").success);
  EXPECT_TRUE(chain->call("reset").success);
  const auto again = process(3);
  EXPECT_EQ(outcome(again), TrackingStatusMsg::FUSED);
  EXPECT_NEAR(again.pose.position.x, 0, 1e-9) << "a new map begins";
  chain->unload();
  EXPECT_EQ(pf::loadTrajectory(folder / "out/trajectory.txt").size(), 1U)
      << "the new map was saved at the end";
}

TEST_F(ChainSaving, AnOutputThatCannotBeWrittenIsAnAnswerNotACrash) {
  std::ofstream(folder / "file") << "in the way";
  load("unwritable", folder / "file");
  process(0);
  const auto response = chain->call("save_map");
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find(folder / "file"), std::string::npos) << response.message;
  EXPECT_EQ(outcome(process(1)), TrackingStatusMsg::FUSED);
  chain->unload();
}

TEST_F(ChainSaving, ATimeJumpBeginsANewMapAndKeepsTheOldOne) {
  load("jump", folder.str());
  playWithAJumpBack();
  ASSERT_TRUE(chain->call("save_map").success);
  EXPECT_EQ(posesIn(folder / "trajectory.txt").substr(0, 5), "1050.");
  EXPECT_EQ(posesIn(folder / "before_reset_1/trajectory.txt").substr(0, 5), "1100.");
  chain->unload();
}

TEST_F(ChainSaving, ATimeJumpBeginsANewMapEvenWhereTheOldOneCannotBeKept) {
  std::ofstream(folder / "before_reset_1") << "in the way of the folder";
  load("jump_unsaved", folder.str());
  playWithAJumpBack();
  chain->unload();
  EXPECT_EQ(posesIn(folder / "trajectory.txt").substr(0, 5), "1050.");
  EXPECT_EQ(posesIn(folder / "trajectory.partial.txt.old").substr(0, 5), "1100.")
      << "at least the poses of the old map are kept";
}

TEST_F(ChainSaving, PosesAreOnTheDiskAsTheyCome) {
  load("journal", folder / "out");
  for (int i = 0; i < 3; ++i) {
    process(i);
    EXPECT_EQ(pf::loadTrajectory(folder / "out/trajectory.partial.txt").size(), i + 1U);
  }
  chain->unload();
  EXPECT_EQ(pf::loadTrajectory(folder / "out/trajectory.txt").size(), 3U);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/trajectory.partial.txt"));
}

}  // namespace
}  // namespace posefusion_ros

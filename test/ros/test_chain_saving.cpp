// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a map: saved, emptied, begun anew.
#include <gtest/gtest.h>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace posefusion_ros {
namespace {

using pf::SimulatedSequence;

TEST(Chain, ResetEmptiesTheMapAndSaveTellsWhere) {
  const pf::TemporaryFolder folder;
  Chain chain("services");
  chain.set("output", folder / "out");
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
  const auto empty = chain.call("save_map");
  EXPECT_TRUE(empty.success);
  EXPECT_NE(empty.message.find("nothing to save"), std::string::npos);
  std::uint64_t grown = 0;
  for (int i = 0; i < 3; ++i) grown = chain.process(toMessages(sequence.frame(i).frame)).surfels;
  EXPECT_GT(grown, 0U);
  const auto saved = chain.call("save_map");
  EXPECT_TRUE(saved.success);
  EXPECT_NE(saved.message.find(folder / "out"), std::string::npos) << saved.message;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/map.ply"));
  EXPECT_TRUE(chain.call("reset").success);
  EXPECT_TRUE(chain.call("reset").success);
  const auto again = chain.process(toMessages(sequence.frame(3).frame));
  EXPECT_EQ(outcome(again), TrackingStatusMsg::FUSED);
  EXPECT_NEAR(again.pose.position.x, 0, 1e-9) << "a new map begins";
  chain.unload();
  EXPECT_EQ(pf::loadTrajectory(folder / "out/trajectory.txt").size(), 1U)
      << "the new map was saved at the end";
}

TEST(Chain, AnOutputThatCannotBeWrittenIsAnAnswerNotACrash) {
  const pf::TemporaryFolder folder;
  std::ofstream(folder / "file") << "in the way";
  Chain chain("unwritable");
  chain.set("output", folder / "file");
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
  chain.process(toMessages(sequence.frame(0).frame));
  const auto response = chain.call("save_map");
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find(folder / "file"), std::string::npos) << response.message;
  EXPECT_EQ(outcome(chain.process(toMessages(sequence.frame(1).frame))), TrackingStatusMsg::FUSED);
  chain.unload();
}

TEST(Chain, ATimeJumpBeginsANewMapAndKeepsTheOldOne) {
  const pf::TemporaryFolder folder;
  Chain chain("jump");
  chain.set("output", folder.str());
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 3; ++i) {
      pf::RgbdFrame frame = sequence.frame(i).frame;
      frame.stamp_ns += (round == 0 ? 100 : 50) * 1000000000L;
      const auto status = chain.process(toMessages(frame));
      EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED) << round << " " << i;
      EXPECT_EQ(toNs(status.header.stamp), frame.stamp_ns);
    }
  }
  ASSERT_TRUE(chain.call("save_map").success);
  EXPECT_EQ(posesIn(folder / "trajectory.txt").substr(0, 5), "1050.");
  EXPECT_EQ(posesIn(folder / "before_reset_1/trajectory.txt").substr(0, 5), "1100.");
  chain.unload();
}

TEST(Chain, ATimeJumpBeginsANewMapEvenWhereTheOldOneCannotBeKept) {
  const pf::TemporaryFolder folder;
  std::ofstream(folder / "before_reset_1") << "in the way of the folder";
  Chain chain("jump_unsaved");
  chain.set("output", folder.str());
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 3; ++i) {
      pf::RgbdFrame frame = sequence.frame(i).frame;
      frame.stamp_ns += (round == 0 ? 100 : 50) * 1000000000L;
      const auto status = chain.process(toMessages(frame));
      EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED) << round << " " << i << status.reason;
    }
  }
  chain.unload();
  EXPECT_EQ(posesIn(folder / "trajectory.txt").substr(0, 5), "1050.");
  EXPECT_EQ(posesIn(folder / "trajectory.partial.txt.old").substr(0, 5), "1100.")
      << "at least the poses of the old map are kept";
}

TEST(Chain, PosesAreOnTheDiskAsTheyCome) {
  const pf::TemporaryFolder folder;
  Chain chain("journal");
  chain.set("output", folder / "out");
  ASSERT_TRUE(chain.load());
  const SimulatedSequence& sequence = emptyRoom();
  for (int i = 0; i < 3; ++i) {
    chain.process(toMessages(sequence.frame(i).frame));
    EXPECT_EQ(pf::loadTrajectory(folder / "out/trajectory.partial.txt").size(), i + 1U);
  }
  chain.unload();
  EXPECT_EQ(pf::loadTrajectory(folder / "out/trajectory.txt").size(), 3U);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/trajectory.partial.txt"));
}

}  // namespace
}  // namespace posefusion_ros

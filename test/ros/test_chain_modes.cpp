// SPDX-License-Identifier: BSD-3-Clause
// Whether frames change the map: modes, pauses, and parameters that contradict each other.
#include <gtest/gtest.h>

#include "loading_fixture.hpp"

namespace posefusion_ros {
namespace {

using ChainModes = ChainLoading;

TEST_F(ChainModes, ParametersThatContradictLeaveTheNodeletIdle) {
  chain->set("localize_only", true);
  ASSERT_TRUE(chain->load({"fusion"}));
  EXPECT_FALSE(ros::service::exists(chain->space() + "/fusion/save_map", false));
  chain->unload();
  chain->set("map_file", folder / "none.pfdb");
  ASSERT_TRUE(chain->load({"fusion"}));
  EXPECT_FALSE(ros::service::exists(chain->space() + "/fusion/save_map", false));
}

TEST_F(ChainModes, TheModeMayChangeAtAnyTime) {
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

TEST_F(ChainModes, WhilePausedFramesAreReportedAndNotLookedAt) {
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

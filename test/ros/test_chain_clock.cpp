// SPDX-License-Identifier: BSD-3-Clause
// Stamps that go back, or on by far: a recording that is played again, a clock that is put right.
#include <gtest/gtest.h>
#include <nav_msgs/Path.h>
#include <posefusion/LoadMap.h>

#include <cmath>
#include <set>

#include "posefusion/io/saved_map_file.hpp"
#include "saving_fixture.hpp"

namespace posefusion_ros {
namespace {

/// As with use_sim_time, while it lives.
class SimulatedTime {
 public:
  SimulatedTime() { ros::Time::setNow(ros::Time(2000)); }
  ~SimulatedTime() { ros::Time::init(); }
  SimulatedTime(const SimulatedTime&) = delete;
  SimulatedTime& operator=(const SimulatedTime&) = delete;
};

class ChainClock : public ChainSaving {
 protected:
  /// Plays three frames, then three that are 50 s earlier; all of them are to be fused.
  void playTwice() {
    for (const int later_s : {100, 50}) {
      for (int i = 0; i < 3; ++i) {
        const auto status = process(i, later_s);
        EXPECT_EQ(outcome(status), TrackingStatusMsg::FUSED)
            << later_s << " " << i << status.reason;
        EXPECT_EQ(toNs(status.header.stamp), emptyRoom().stamp(i) + later_s * 1000000000L);
      }
    }
  }

  /// The camera stands still at frame 5: the statuses of so many frames of it, from a stamp on.
  std::vector<TrackingStatusMsg> stand(int frames, std::int64_t from_s) {
    std::vector<TrackingStatusMsg> statuses;
    const CameraMessages still = toMessages(emptyRoom().frame(5).frame);
    for (int i = 0; i < frames; ++i) {
      const std::int64_t stamp_ns = from_s * 1000000000L + i * 33000000L;
      statuses.push_back(chain->process(restamped(still, stamp_ns)));
    }
    return statuses;
  }

  static double distance(const TrackingStatusMsg& a, const TrackingStatusMsg& b) {
    return std::hypot(a.pose.position.x - b.pose.position.x, a.pose.position.y - b.pose.position.y,
                      a.pose.position.z - b.pose.position.z);
  }
};

TEST_F(ChainClock, ARecordingThatIsPlayedAgainBeginsANewMapAndKeepsTheOldOne) {
  const SimulatedTime simulated;
  load("loop", folder / "out");
  playTwice();
  ASSERT_TRUE(chain->call("save_map").success);
  ASSERT_EQ(runs().size(), 2U);
  EXPECT_EQ(posesIn(runs()[0] + "/trajectory.txt").substr(0, 5), "1100.");
  EXPECT_EQ(posesIn(saves()[0] + "/trajectory.txt").substr(0, 5), "1050.");
  chain->unload();
}

TEST_F(ChainClock, OfMapsEndedUnaskedANumberIsKept) {
  const SimulatedTime simulated;
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

TEST_F(ChainClock, ARecordingBeginsANewMapEvenWhereTheOldOneCannotBeKept) {
  const SimulatedTime simulated;
  load("loop_unsaved", folder / "out");
  std::filesystem::create_directories(runs().front() + "/map.ply/in the way");
  playTwice();
  chain->unload();
  ASSERT_EQ(runs().size(), 2U);
  EXPECT_EQ(posesIn(runs()[1] + "/trajectory.txt").substr(0, 5), "1050.");
  EXPECT_EQ(posesIn(runs()[0] + "/trajectory.partial.txt").substr(0, 5), "1100.")
      << "at least the poses of the old map are kept";
}

TEST_F(ChainClock, AClockThatIsPutBackGoesOnInTheSameMap) {
  load("put_back", folder / "out");
  for (int i = 0; i < 6; ++i) EXPECT_EQ(outcome(process(i, 100)), TrackingStatusMsg::FUSED);
  const TrackingStatusMsg before = chain->statuses().back();
  std::mutex mutex;
  nav_msgs::Path path;
  const boost::function<void(const nav_msgs::Path::ConstPtr&)> on_path =
      [&](const nav_msgs::Path::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        path = *message;
      };
  const auto subscriber = chain->handle().subscribe<nav_msgs::Path>(topics::kPath, 10, on_path);
  const auto after = stand(40, 1050);
  EXPECT_EQ(after.front().state, TrackingStatusMsg::LOST) << "it is looked for";
  EXPECT_GE(after.front().surfels, before.surfels) << "nothing is forgotten";
  EXPECT_EQ(after.back().state, TrackingStatusMsg::TRACKING) << after.back().reason;
  EXPECT_LT(distance(after.back(), before), 0.01) << "the origin is the same";
  EXPECT_TRUE(std::filesystem::exists(runs().front() + "/map.pfdb")) << "saved at the jump";
  EXPECT_TRUE(Chain::waitUntil([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return !path.poses.empty() && path.poses.front().header.stamp < ros::Time(1060);
  })) << "the path is of the new time";
  chain->unload();
  ASSERT_EQ(runs().size(), 1U) << "one map, one folder";
  const std::string poses = posesIn(runs()[0] + "/trajectory.txt");
  EXPECT_EQ(poses.substr(0, 5), "1100.") << "in the order in which they came";
  EXPECT_NE(poses.find("\n1050."), std::string::npos);
  const auto located = static_cast<std::size_t>(
      std::count_if(after.begin(), after.end(), [](const auto& s) { return s.located != 0; }));
  EXPECT_EQ(posesOf(runs()[0] + "/trajectory.txt"), 6 + located);
  EXPECT_EQ(pf::readSavedMap(runs()[0] + "/map.pfdb").frames.size(), 6 + located);
  EXPECT_FALSE(std::filesystem::exists(runs()[0] + "/trajectory.partial.txt"));
}

TEST_F(ChainClock, AClockIsPutBackThoughTheMapCannotBeSaved) {
  load("put_back_unsaved", folder / "out");
  for (int i = 0; i < 6; ++i) process(i, 100);
  std::filesystem::create_directories(runs().front() + "/map.ply/in the way");
  const auto after = stand(40, 1050);
  EXPECT_EQ(after.back().state, TrackingStatusMsg::TRACKING) << after.back().reason;
  std::filesystem::remove_all(runs().front() + "/map.ply");
  chain->unload();
  EXPECT_GT(posesOf(runs()[0] + "/trajectory.txt"), 7U) << "nothing was lost";
}

TEST_F(ChainClock, AClockThatIsPutForwardLosesNothing) {
  load("put_forward", folder / "out");
  for (int i = 0; i < 6; ++i) process(i, 0);
  const TrackingStatusMsg before = chain->statuses().back();
  const auto after = stand(20, 1000 + 3600);
  EXPECT_EQ(after.back().state, TrackingStatusMsg::TRACKING) << after.back().reason;
  EXPECT_LT(distance(after.back(), before), 0.01);
  chain->unload();
  ASSERT_EQ(runs().size(), 1U);
  EXPECT_GT(posesOf(runs()[0] + "/trajectory.txt"), 6U);
}

TEST_F(ChainClock, AMapThatIsLoadedFromAnEndedOneIsNotRemoved) {
  chain.emplace("loaded_stays");
  chain->set("output", folder / "out");
  chain->set("maps_kept", 1);
  ASSERT_TRUE(chain->load());
  process(0);
  ASSERT_TRUE(chain->call("reset").success);
  const std::string first = runs().front();
  posefusion::LoadMap load;
  process(1);
  load.request.file = "latest/map.pfdb";
  ASSERT_TRUE(ros::service::call(chain->space() + "/fusion/load_map", load));
  ASSERT_TRUE(load.response.success) << load.response.message;
  EXPECT_TRUE(std::filesystem::exists(first + "/map.pfdb"))
      << "it is loaded, though it is the oldest of two";
}

}  // namespace
}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
// A camera that is lost for long maps a fragment of unknown pose, and returns to the map.
#include <gtest/gtest.h>
#include <tf2_msgs/TFMessage.h>

#include <filesystem>
#include <set>

#include "../temporary_folder.hpp"
#include "chain_fixture.hpp"
#include "posefusion/io/saved_map_file.hpp"

namespace posefusion_ros {
namespace {

namespace fs = std::filesystem;

constexpr int kMapped = 60, kCovered = 20, kLookedAbout = 6, kPatience = 60;

const pf::SimulatedSequence& room() { return pf::exactBox<kMapped>(); }

std::size_t surfelsInFragment(const std::vector<pf::FragmentSurfels>& parts) {
  std::size_t count = 0;
  for (const pf::FragmentSurfels& part : parts) {
    if (part.fragment == 1) count += part.surfels.size();
  }
  return count;
}

class ChainFragments : public testing::Test {
 protected:
  void SetUp() override {
    chain.set("frame/shrink", 1);
    chain.set("loop/new_fragment_after_s", 0.1);  // before the search for the place has an answer
    chain.set("loop/min_gap_keyframes",
              1000);  // it is that search that joins, no pair of keyframes
    chain.set("blur/enabled", false);
    chain.set("closer_timeout_s", 1.0);
    chain.set("output", folder / "out");
    const boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)> note =
        [this](const auto& message) {
          const std::lock_guard<std::mutex> lock(mutex);
          for (const auto& transform : message->transforms) {
            if (transform.header.frame_id == frames::kMap) sent.insert(transform.header.stamp);
          }
        };
    transforms = chain.handle().subscribe<tf2_msgs::TFMessage>("/tf", 1000, note);
  }
  void TearDown() override { transforms.shutdown(); }

  TrackingStatusMsg see(int index, bool covered = false) {
    pf::RgbdFrame frame = room().frame(index).frame;
    frame.stamp_ns = stamp_ns += 33333333;
    if (covered) {
      frame.depth.setTo(0);
      frame.color.setTo(128);  // nor are corners followed
    }
    return chain.process(toMessages(frame));
  }

  /// Maps the room, covers the camera for long, and uncovers it elsewhere, where a fragment begins.
  void carryOff() {
    for (int i = 0; i < kMapped / 2; ++i) EXPECT_TRUE(see(i).located) << i;
    for (int i = 0; i < kCovered; ++i) see(kMapped / 2, true);
    TrackingStatusMsg status;
    for (int i = 0; i < kLookedAbout; ++i) status = see(kMapped - 1);
    ASSERT_EQ(status.fragment, 1U) << status.reason;
    EXPECT_FALSE(status.located);
  }

  /// A transform of that stamp, once it has had its time.
  bool isSent(const ros::Time& stamp) {
    return Chain::waitUntil([&] {
      const std::lock_guard<std::mutex> lock(mutex);
      return sent.count(stamp) > 0;
    });
  }

  /// The folder of the one run.
  fs::path run() const {
    for (const auto& entry : fs::directory_iterator(folder / "out")) {
      if (!entry.is_symlink()) return entry.path();
    }
    return {};
  }

  const pf::TemporaryFolder folder;
  Chain chain{testing::UnitTest::GetInstance()->current_test_info()->name()};
  std::int64_t stamp_ns = 1'000'000'000;
  std::mutex mutex;
  std::set<ros::Time> sent;  // stamps of map -> camera
  ros::Subscriber transforms;
};

TEST_F(ChainFragments, OneHasNoTransformsUntilItIsJoined) {
  ASSERT_TRUE(chain.load());
  carryOff();
  std::set<ros::Time> apart;
  TrackingStatusMsg status;
  for (int i = 1; i < kPatience; ++i) {
    status = see(kMapped - 1 - i % (kMapped / 2));
    ASSERT_EQ(static_cast<int>(status.state), static_cast<int>(TrackingStatusMsg::TRACKING))
        << i << status.reason;
    if (status.fragment == 0) break;
    EXPECT_FALSE(status.located);
    apart.insert(status.header.stamp);
  }
  ASSERT_EQ(status.fragment, 0U) << "not joined within " << kPatience << " frames";
  EXPECT_GT(apart.size(), 5U);
  EXPECT_TRUE(status.located);
  EXPECT_TRUE(isSent(status.header.stamp)) << "transforms go on";
  const std::lock_guard<std::mutex> lock(mutex);
  for (const ros::Time& stamp : apart) EXPECT_EQ(sent.count(stamp), 0U) << stamp;
  EXPECT_GT(sent.size(), std::size_t{kMapped / 2} - 1);
}

TEST_F(ChainFragments, WhatIsMappedInOneIsOnTheDiskBeforeItIsJoined) {
  ASSERT_TRUE(chain.loadWithoutCloser());
  carryOff();
  const std::string copy = folder / "copy.pfdb";
  pf::SavedMap left;
  // As after a kill: what lies on the disk, with the companion file of the database.
  const auto isOnTheDisk = [&] {
    try {
      for (const char* part : {"", "-wal"}) {
        fs::copy_file(run() / ("map.partial.pfdb" + std::string(part)), copy + part,
                      fs::copy_options::overwrite_existing);
      }
      left = pf::readSavedMap(copy);
    } catch (const std::exception&) {
      return false;  // it is being written
    }
    return surfelsInFragment(left.surfels) > 1000;
  };
  bool found = false;
  for (int i = 1; i < kPatience && !found; ++i) {
    const TrackingStatusMsg status = see(kMapped - 1 - i % (kMapped / 2));
    ASSERT_EQ(status.fragment, 1U);
    ros::WallDuration(0.05).sleep();  // the file is written once a second
    found = isOnTheDisk();
  }
  ASSERT_TRUE(found);
  pf::Mapper mapper{pf::Config()};
  mapper.load(std::move(left), pf::MapUse::extend);
  EXPECT_EQ(mapper.backEnd().graph().keyframes().back().fragment, 1);
}

}  // namespace
}  // namespace posefusion_ros

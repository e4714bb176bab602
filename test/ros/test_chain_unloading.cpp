// SPDX-License-Identifier: BSD-3-Clause
// Nodelets that go while they are at work. Unloading does not wait: a thread of the manager that is
// in a callback of the nodelet destroys it. chain.test has freed memory overwritten, so that a use
// of it is seen.
#include <gtest/gtest.h>
#include <ros/service_manager.h>
#include <ros/service_publication.h>
#include <visualization_msgs/MarkerArray.h>

#include <atomic>
#include <thread>

#include "chain_fixture.hpp"

namespace posefusion_ros {
namespace {

using pf::SimulatedSequence;

/// Does something again and again, in a thread of its own.
class Repeated {
 public:
  template <typename Action>
  explicit Repeated(Action action)
      : thread_([this, action] {
          while (!ends_) {
            action();
            ++times_;
          }
        }) {}
  ~Repeated() {
    ends_ = true;
    thread_.join();
  }
  int times() const { return times_; }

 private:
  std::atomic<bool> ends_{false};
  std::atomic<int> times_{0};
  std::thread thread_;
};

TEST(ChainUnloading, FusionGoesWhileItsServicesAreCalled) {
  Chain chain("services_called");
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(chain.load({"fusion"}));
    const auto caller = [&chain](const char* service) {
      return [&chain, service] {
        std_srvs::Trigger call;
        ros::service::call(chain.space() + "/fusion/" + service, call);
      };
    };
    const Repeated resets(caller("reset")), saves(caller("save_map"));
    ASSERT_TRUE(Chain::waitUntil([&] { return resets.times() > 2 && saves.times() > 2; }));
    chain.unload("fusion");
    ASSERT_TRUE(chain.hasLostFusion());
  }
}

// roscpp's network thread holds a service while it reads a request.
TEST(ChainUnloading, FusionGoesBeforeARequestHasArrived) {
  Chain chain("request");
  ASSERT_TRUE(chain.load({"fusion"}));
  auto service =
      ros::ServiceManager::instance()->lookupServicePublication(chain.space() + "/fusion/reset");
  ASSERT_TRUE(service);
  chain.unload("fusion");
  ASSERT_TRUE(chain.hasLostFusion());
  service->processRequest({}, 0, nullptr);
  service.reset();
}

TEST(ChainUnloading, SkeletonsDoNotOutliveTheirPeople) {
  using visualization_msgs::MarkerArray;
  Chain chain("skeletons_go");
  std::mutex mutex;
  std::vector<MarkerArray> arrays;
  const boost::function<void(const MarkerArray::ConstPtr&)> on_markers =
      [&](const MarkerArray::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        arrays.push_back(*message);
      };
  const auto subscriber = chain.handle().subscribe<MarkerArray>(topics::kSkeletons, 10, on_markers);
  ASSERT_TRUE(chain.load());
  ASSERT_TRUE(Chain::waitUntil([&] { return subscriber.getNumPublishers() > 0; }));
  const auto isCleared = [&](std::size_t count) {
    return Chain::waitUntil([&] {
      const std::lock_guard<std::mutex> lock(mutex);
      return arrays.size() >= count && arrays.back().markers.size() == 1 &&
             arrays.back().markers[0].action == visualization_msgs::Marker::DELETEALL;
    });
  };
  chain.process(toMessages(emptyRoom().frame(0).frame));
  EXPECT_TRUE(isCleared(1)) << "no person is there";
  ASSERT_TRUE(chain.call("reset").success);
  EXPECT_TRUE(isCleared(2)) << "the map was emptied";
  chain.unload("segmenter");
  EXPECT_TRUE(isCleared(3)) << "the segmenter has gone";
}

TEST(ChainUnloading, EachGoesWhileImagesFlow) {
  Chain chain("images_flow");
  chain.set("lossless", false);
  const SimulatedSequence sequence("box_walker", 4);
  std::vector<CameraMessages> messages;
  for (int i = 0; i < 4; ++i) messages.push_back(toMessages(sequence.frame(i).frame));
  std::int64_t stamp_ns = 1'000'000'000;
  const Repeated camera([&] {
    CameraMessages m = messages[static_cast<std::size_t>(stamp_ns / 33'000'000 % 4)];
    stamp_ns += 33'000'000;
    chain.send(restamped(m, stamp_ns));
    ros::WallDuration(0.01).sleep();
  });
  const auto& nodelets = Chain::nodelets();
  for (std::size_t first = 0; first < 2 * nodelets.size(); ++first) {
    ASSERT_TRUE(chain.load());
    ASSERT_TRUE(chain.waitForStatuses(chain.statuses().size() + 3));
    for (std::size_t i = 0; i < nodelets.size(); ++i) {
      chain.unload(nodelets[(first + i) % nodelets.size()]);
    }
    ASSERT_TRUE(chain.hasLostFusion());
  }
}

}  // namespace
}  // namespace posefusion_ros

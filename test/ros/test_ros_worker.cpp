// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/worker.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "posefusion_ros/credit_window.hpp"
#include "posefusion_ros/latency.hpp"

namespace posefusion_ros {
namespace {

using std::chrono::duration;

TEST(Worker, HandlesAllItemsInOrder) {
  std::vector<int> seen;
  std::promise<void> done;
  Worker<int> worker(0, [&](int item) {
    seen.push_back(item);
    if (item == 99) done.set_value();
  });
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(worker.push(i));
  done.get_future().get();
  ASSERT_EQ(seen.size(), 100U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(seen[i], i);
}

/// A worker that is busy with item 0 until it is let go, and notes what it handles.
class HeldWorker {
 public:
  explicit HeldWorker(std::size_t limit) : worker(limit, [this](int item) { handle(item); }) {
    worker.push(0);
    begun_.get_future().get();
  }

  /// Returns when all that waits is handled.
  void letGo() {
    gate_.set_value();
    while (worker.waiting() > 0) std::this_thread::yield();
    worker.post([] {}).get();
  }

  std::vector<int> seen;

 private:
  void handle(int item) {
    if (item == 0) begun_.set_value();
    opened_.wait();
    seen.push_back(item);
  }

  std::promise<void> gate_, begun_;
  std::shared_future<void> opened_ = gate_.get_future().share();

 public:
  Worker<int> worker;  // last: its thread uses all the others
};

TEST(Worker, GivesBackTheOldestWhenTooManyWait) {
  HeldWorker held(2);
  EXPECT_FALSE(held.worker.push(1));
  EXPECT_FALSE(held.worker.push(2));
  EXPECT_EQ(held.worker.push(3), std::optional<int>(1));
  EXPECT_EQ(held.worker.waiting(), 2U);
  held.letGo();
  EXPECT_EQ(held.seen.front(), 0);
}

TEST(Worker, WhatIsUrgentIsHandledNext) {
  HeldWorker held(0);
  for (int i = 1; i < 50; ++i) held.worker.push(i);
  held.worker.pushFirst(99);
  held.letGo();
  ASSERT_EQ(held.seen.size(), 51U);
  EXPECT_EQ(held.seen[0], 0);
  EXPECT_EQ(held.seen[1], 99);
  EXPECT_EQ(held.seen[2], 1);
}

TEST(Worker, TasksRunBeforeWaitingItems) {
  HeldWorker held(0);
  held.worker.push(1);
  auto task = held.worker.post([&] { held.seen.push_back(-1); });
  held.letGo();
  task.get();
  EXPECT_EQ(held.seen, (std::vector<int>{0, -1, 1}));
}

TEST(Worker, ATaskThatNeverRunsBreaksItsPromise) {
  std::future<void> task;
  std::promise<void> begun;
  {
    std::promise<void> gate;
    const auto opened = gate.get_future().share();
    Worker<int> worker(0, [&](int) {
      begun.set_value();
      opened.wait();
    });
    worker.push(0);
    begun.get_future().get();
    task = worker.post([] {});
    // The worker is stopped while it is busy: waiting for the task behind must end.
    std::thread opener([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      gate.set_value();
    });
    opener.detach();
  }
  EXPECT_THROW(task.get(), std::future_error);
}

TEST(CreditWindow, OneStatusIsOneCredit) {
  CreditWindow window;
  window.sent(1);
  window.sent(2);
  EXPECT_FALSE(window.waitBelow(2, duration<double>(0.01)));
  EXPECT_TRUE(window.reported(1));
  EXPECT_TRUE(window.waitBelow(2, duration<double>(0.01)));
  EXPECT_FALSE(window.reported(1)) << "a second status for the frame is no credit";
  EXPECT_EQ(window.underWay(), 1U);
}

TEST(CreditWindow, WaitsWhileStatusesComeIn) {
  CreditWindow window;
  for (int i = 0; i < 20; ++i) window.sent(i);
  std::thread chain([&] {
    for (int i = 0; i < 20; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      window.reported(i);
    }
  });
  EXPECT_TRUE(window.waitBelow(1, duration<double>(5.0)));
  chain.join();
  window.sent(50);
  EXPECT_FALSE(window.waitBelow(1, duration<double>(1000.0), [] { return false; }));
}

TEST(LatencyMeter, GivesQuantilesOfTheLatency) {
  LatencyMeter meter;
  EXPECT_EQ(meter.quantile(0.5), 0.0);
  const LatencyMeter::Time start;
  for (int i = 0; i <= 100; ++i) meter.sent(i, start);
  // The later frame is the quicker one.
  for (int i = 0; i <= 100; ++i) meter.arrived(i, start + std::chrono::milliseconds(100 - i));
  meter.arrived(7, start + std::chrono::hours(1));     // a second result
  meter.arrived(1000, start + std::chrono::hours(1));  // of no frame
  EXPECT_EQ(meter.count(), 101U);
  EXPECT_NEAR(meter.quantile(0.5), 0.050, 1e-9);
  EXPECT_NEAR(meter.quantile(0.99), 0.099, 1e-9);
}

}  // namespace
}  // namespace posefusion_ros

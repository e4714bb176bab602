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

TEST(Worker, GivesBackTheOldestWhenTooManyWait) {
  std::promise<void> gate, begun;
  const auto opened = gate.get_future().share();
  std::vector<int> seen;
  Worker<int> worker(2, [&](int item) {
    if (item == 0) begun.set_value();
    opened.wait();
    seen.push_back(item);
  });
  worker.push(0);
  begun.get_future().get();
  EXPECT_FALSE(worker.push(1));
  EXPECT_FALSE(worker.push(2));
  EXPECT_EQ(worker.push(3), std::optional<int>(1));
  EXPECT_EQ(worker.waiting(), 2U);
  gate.set_value();
  while (worker.waiting() > 0) std::this_thread::yield();
  worker.post([] {}).get();
  EXPECT_EQ(seen.front(), 0);
}

TEST(Worker, WhatIsUrgentIsHandledNext) {
  std::promise<void> gate, begun;
  const auto opened = gate.get_future().share();
  std::vector<int> seen;
  Worker<int> worker(0, [&](int item) {
    if (item == 0) begun.set_value();
    opened.wait();
    seen.push_back(item);
  });
  worker.push(0);
  begun.get_future().get();
  for (int i = 1; i < 50; ++i) worker.push(i);
  worker.pushFirst(99);
  gate.set_value();
  while (worker.waiting() > 0) std::this_thread::yield();
  worker.post([] {}).get();
  ASSERT_EQ(seen.size(), 51U);
  EXPECT_EQ(seen[0], 0);
  EXPECT_EQ(seen[1], 99);
  EXPECT_EQ(seen[2], 1);
}

TEST(Worker, TasksRunBeforeWaitingItems) {
  std::promise<void> gate, begun, done;
  const auto opened = gate.get_future().share();
  std::vector<int> order;
  Worker<int> worker(0, [&](int item) {
    if (item == 0) begun.set_value();
    opened.wait();
    order.push_back(item);
    if (item == 1) done.set_value();
  });
  worker.push(0);
  begun.get_future().get();
  worker.push(1);
  auto task = worker.post([&] { order.push_back(-1); });
  gate.set_value();
  task.get();
  done.get_future().get();
  EXPECT_EQ(order, (std::vector<int>{0, -1, 1}));
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
    // The worker is told to stop while it is busy: the task behind must not be waited for for ever.
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

TEST(LatencyMeter, TellsWithinWhichTimeAPartOfTheResultsCame) {
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

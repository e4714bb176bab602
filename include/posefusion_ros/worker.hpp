// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace posefusion_ros {

/// A thread that handles items in order, so that ROS callbacks stay short and every item that is
/// given up is known. Tasks run between two items, before those that wait. The handler and the
/// tasks must not throw. Items that wait when it is destroyed are not handled.
template <typename Item>
class Worker {
 public:
  /// At most `limit` items wait (0: any number).
  Worker(std::size_t limit, std::function<void(Item)> handler)
      : limit_(limit), handler_(std::move(handler)), thread_([this] { run(); }) {}

  ~Worker() { stop(); }

  /// Waits for the item at hand. Where the handler asks its owner for the worker, this must come
  /// before the owner lets go of it.
  void stop() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  /// Adds an item. The oldest one is returned where too many wait.
  std::optional<Item> push(Item item) {
    std::optional<Item> dropped;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      items_.push_back(std::move(item));
      if (limit_ > 0 && items_.size() > limit_) {
        dropped = std::move(items_.front());
        items_.pop_front();
      }
    }
    changed_.notify_all();
    return dropped;
  }

  /// Adds an item that is handled next, before all that wait.
  void pushFirst(Item item) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      items_.push_front(std::move(item));
    }
    changed_.notify_all();
  }

  /// Runs `task` before the next item. The future is broken when the worker ends first.
  std::future<void> post(std::function<void()> task) {
    std::packaged_task<void()> packaged(std::move(task));
    std::future<void> done = packaged.get_future();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      tasks_.push_back(std::move(packaged));
    }
    changed_.notify_all();
    return done;
  }

  std::size_t waiting() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return items_.size();
  }

 private:
  void run() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      changed_.wait(lock, [this] { return stopping_ || !tasks_.empty() || !items_.empty(); });
      if (stopping_) return;
      if (!tasks_.empty()) {
        std::packaged_task<void()> task = std::move(tasks_.front());
        tasks_.pop_front();
        lock.unlock();
        task();
      } else {
        Item item = std::move(items_.front());
        items_.pop_front();
        lock.unlock();
        handler_(std::move(item));
      }
      lock.lock();
    }
  }

  std::size_t limit_;
  std::function<void(Item)> handler_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  std::deque<std::packaged_task<void()>> tasks_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nodelet/detail/callback_queue.h>
#include <ros/node_handle.h>

#include <boost/smart_ptr/shared_ptr.hpp>
#include <mutex>
#include <vector>

namespace posefusion_ros {

/// Keeps the callback queues of a nodelet: to be its first member, filled first in onInit().
/// Unloading frees the queues too early (nodelet 1.10):
/// - A thread of the manager that is still in a callback keeps the nodelet until that returns:
///   destroyed then, its services, timers and publishers remove themselves from their queues.
/// - The network thread may hold a service a moment longer, to put a request into the queue.
class QueueKeeper {
 public:
  QueueKeeper() = default;
  /// Closes the queues, and keeps them for good: it is unknown when the network thread is done.
  ~QueueKeeper() {
    static std::mutex& mutex = *new std::mutex;  // not destroyed either
    static auto& closed = *new Queues;
    for (const auto& queue : queues_) queue->disable();
    const std::lock_guard<std::mutex> lock(mutex);
    closed.insert(closed.end(), queues_.begin(), queues_.end());
  }
  QueueKeeper(const QueueKeeper&) = delete;
  QueueKeeper& operator=(const QueueKeeper&) = delete;

  /// `handle`: one of the nodelet's own. Another queue than a nodelet's is left to its owner.
  void keep(const ros::NodeHandle& handle) {
    using Queue = nodelet::detail::CallbackQueue;
    if (auto* queue = dynamic_cast<Queue*>(handle.getCallbackQueue())) {
      queues_.push_back(queue->shared_from_this());
    }
  }

 private:
  using Queues = std::vector<boost::shared_ptr<nodelet::detail::CallbackQueue>>;

  Queues queues_;
};

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nodelet/detail/callback_queue.h>
#include <ros/node_handle.h>

#include <boost/smart_ptr/shared_ptr.hpp>
#include <vector>

namespace posefusion_ros {

/// Keeps the callback queues of a nodelet as long as the nodelet: to be its first member, filled
/// first in onInit(). Unloading frees the queues, but a thread of the manager that is still in a
/// callback keeps the nodelet until that returns: destroyed then, its services, timers and
/// publishers remove themselves from queues that would be gone (nodelet 1.10).
class QueueKeeper {
 public:
  /// `handle`: one of the nodelet's own. Another queue than a nodelet's is left to its owner.
  void keep(const ros::NodeHandle& handle) {
    using Queue = nodelet::detail::CallbackQueue;
    if (auto* queue = dynamic_cast<Queue*>(handle.getCallbackQueue())) {
      queues_.push_back(queue->shared_from_this());
    }
  }

 private:
  std::vector<boost::shared_ptr<nodelet::detail::CallbackQueue>> queues_;
};

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <mutex>

#include "posefusion_ros/stage_messages.hpp"

namespace posefusion_ros {

/// Keeps the flow of every frame until fusion asks for it, so that a frame that is dropped on the
/// way (live) does not break the chain of corners from fused frame to fused frame. Thread safe.
class FlowChain {
 public:
  /// `capacity`: flows that wait at most; beyond it the oldest is forgotten.
  explicit FlowChain(std::size_t capacity) : capacity_(capacity) {}

  /// To be called for each frame, in their order.
  void add(const SparseFlowMsg::ConstPtr& flow);

  /// The flow that leads to the frame of this stamp from the one that was taken before it: that of
  /// the frame itself, joined to those of the frames between. Empty where nothing is known of the
  /// frame. Throws InputError for a message that is none of ours.
  pf::SparseFlow take(const ros::Time& stamp);

 private:
  std::size_t capacity_;
  std::mutex mutex_;
  std::deque<SparseFlowMsg::ConstPtr> waiting_;
};

}  // namespace posefusion_ros

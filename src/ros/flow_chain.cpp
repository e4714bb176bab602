// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/flow_chain.hpp"

#include <algorithm>
#include <vector>

namespace posefusion_ros {

void FlowChain::add(const SparseFlowMsg::ConstPtr& flow) {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.push_back(flow);
  if (waiting_.size() > capacity_) waiting_.pop_front();
}

pf::SparseFlow FlowChain::take(const ros::Time& stamp) {
  std::vector<SparseFlowMsg::ConstPtr> links;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    // By place, not by stamp: after a jump back in time stamps do not rise.
    const auto last = std::find_if(waiting_.begin(), waiting_.end(),
                                   [&](const auto& flow) { return flow->header.stamp == stamp; });
    if (last == waiting_.end()) return {};
    links.assign(waiting_.begin(), last + 1);
    waiting_.erase(waiting_.begin(), last + 1);
  }
  pf::SparseFlow flow = fromMessage(*links.front());
  for (std::size_t i = 1; i < links.size(); ++i) flow = pf::join(flow, fromMessage(*links[i]));
  return flow;
}

}  // namespace posefusion_ros

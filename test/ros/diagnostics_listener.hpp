// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>

#include <map>
#include <mutex>
#include <string>

#include "chain_fixture.hpp"

namespace posefusion_ros {

/// The newest status of each nodelet of a chain.
class Diagnostics {
 public:
  explicit Diagnostics(Chain& chain) : space_(chain.space().substr(1) + "/") {
    chain.set("diagnostic_period", 0.05);
    subscriber_ = chain.handle().subscribe("/diagnostics", 100, &Diagnostics::on, this);
  }
  ~Diagnostics() { subscriber_.shutdown(); }

  diagnostic_msgs::DiagnosticStatus of(const std::string& nodelet) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = newest_.find(space_ + nodelet + ": frames");
    return found == newest_.end() ? diagnostic_msgs::DiagnosticStatus() : found->second;
  }
  std::string value(const std::string& nodelet, const std::string& key) const {
    for (const auto& each : of(nodelet).values) {
      if (each.key == key) return each.value;
    }
    return "none";
  }
  bool waitFor(const std::string& nodelet, const std::string& key,
               const std::string& value_) const {
    return Chain::waitUntil([&] { return value(nodelet, key) == value_; });
  }

 private:
  void on(const diagnostic_msgs::DiagnosticArray::ConstPtr& all) {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& status : all->status) newest_[status.name] = status;
  }

  std::string space_;
  mutable std::mutex mutex_;
  std::map<std::string, diagnostic_msgs::DiagnosticStatus> newest_;
  ros::Subscriber subscriber_;
};

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/Image.h>

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "posefusion/run/run_report.hpp"
#include "posefusion_ros/bags/messages.hpp"

namespace posefusion_ros {

/// What a replay gives, written as the offline runner does: summary.json, map.png and people.png
/// beside what fusion saves. Puts each frame together with its mask, its people and its status.
class ReplayReport {
 public:
  /// `output`: that of fusion, the folder of the folders.
  ReplayReport(ros::NodeHandle& handle, const pf::Config& config, std::string output,
               const pf::Trajectory& truth);

  /// A frame was sent, a status came. Thread safe.
  void sent(const pf::RgbdFrame& frame);
  void reported(const TrackingStatusMsg& status);

  /// Once fusion has saved. Returns a table for people, and where the files are. Throws InputError
  /// where fusion has saved nothing, or naming the file.
  std::string write();

 private:
  struct Frame {
    pf::ProcessedFrame whole;
    bool has_mask = false, has_people = false;
    std::optional<TrackingStatusMsg> status;
  };

  void onMask(const sensor_msgs::ImageConstPtr& mask);
  void onPeople(const PeopleMsg::ConstPtr& people);
  Frame* find(const ros::Time& stamp);
  void take(bool all);
  std::string latest() const;

  std::mutex mutex_;
  std::string output_;
  std::string latest_before_;  // the run that was the latest when this one began
  pf::RunReport report_;
  std::map<std::int64_t, Frame> under_way_;
  ros::Subscriber mask_, people_;
};

}  // namespace posefusion_ros

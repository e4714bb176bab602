// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/synchronizer.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "posefusion_ros/parameters.hpp"

namespace posefusion_ros {

struct PairingSettings {
  int queue_size = 10;
  bool approximate = true;       ///< false: equal stamps only
  double max_interval_s = 0.02;  ///< approximate: first to last stamp of a set
  double time_jump_threshold_s = 1.0;
};

PairingSettings readPairing(Parameters& parameters);

/// Brings colour, depth and camera_info of the camera together, and accounts for every colour
/// image: each is either handed over in a set or given up with a reason. Not thread safe.
class InputPairing {
 public:
  struct Handlers {
    std::function<void(const sensor_msgs::ImageConstPtr&, const sensor_msgs::ImageConstPtr&,
                       const sensor_msgs::CameraInfoConstPtr&)>
        set;
    std::function<void(const std_msgs::Header&, const std::string& reason)> unused;
    /// Stamps went back by more than the threshold: everything begins anew.
    std::function<void(double seconds)> jump;
  };

  InputPairing(const PairingSettings& settings, Handlers handlers);

  void addColor(const sensor_msgs::ImageConstPtr& image);
  void addDepth(const sensor_msgs::ImageConstPtr& image);
  void addInfo(const sensor_msgs::CameraInfoConstPtr& info);

  /// What has arrived so far, for the message that tells what is missing.
  std::string describeArrivals(const std::array<std::string, 3>& topics) const;

 private:
  using Policy =
      message_filters::sync_policies::ApproximateTime<sensor_msgs::Image, sensor_msgs::Image,
                                                      sensor_msgs::CameraInfo>;
  using Synchronizer = message_filters::Synchronizer<Policy>;
  enum Stream { kColor, kDepth, kInfo, kStreams };

  struct Arrivals {
    std::size_t count = 0;
    ros::Time newest;
  };

  void restart();
  /// Whether a message of this stamp may go on; `reason` tells why not.
  bool admit(Stream stream, const ros::Time& stamp, std::string& reason);
  void onSet(const sensor_msgs::ImageConstPtr& color, const sensor_msgs::ImageConstPtr& depth,
             const sensor_msgs::CameraInfoConstPtr& info);
  void giveUp(const std_msgs::Header& header);

  PairingSettings settings_;
  Handlers handlers_;
  std::unique_ptr<Synchronizer> synchronizer_;
  std::deque<std_msgs::Header> waiting_;  // colour images without a set yet
  std::array<Arrivals, kStreams> arrivals_;
};

}  // namespace posefusion_ros

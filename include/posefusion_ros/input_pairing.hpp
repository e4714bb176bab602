// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/synchronizer.h>
#include <array>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "posefusion_ros/bags/input_image.hpp"

namespace posefusion_ros {

struct PairingSettings {
  int queue_size = 10;
  bool approximate = true;       ///< false: equal stamps only
  double max_interval_s = 0.02;  ///< approximate: between the stamps of colour and depth
  double time_jump_threshold_s = 1.0;
};

/// The newest camera_info messages of a topic.
class CameraInfos {
 public:
  void add(const sensor_msgs::CameraInfoConstPtr& info, std::size_t kept);
  /// That of the stamp, else the newest: one that was sent once holds from then on. May be null.
  sensor_msgs::CameraInfoConstPtr find(const ros::Time& stamp) const;

 private:
  std::deque<sensor_msgs::CameraInfoConstPtr> infos_;
};

/// Brings colour and depth of the camera together and adds its camera_info, and accounts for every
/// colour image: each is either handed over in a set or given up with a reason. Not thread safe.
class InputPairing {
 public:
  struct Set {
    InputImage color, depth;
    sensor_msgs::CameraInfoConstPtr info;
    sensor_msgs::CameraInfoConstPtr depth_info;  ///< may be null
  };
  struct Handlers {
    std::function<void(const Set&)> set;
    std::function<void(const std_msgs::Header&, const std::string& reason)> unused;
    /// Stamps went back by more than the threshold: images are paired anew.
    std::function<void(double seconds)> jump;
  };

  InputPairing(const PairingSettings& settings, Handlers handlers);

  void addColor(const InputImage& image);
  void addDepth(const InputImage& image);
  void addInfo(const sensor_msgs::CameraInfoConstPtr& info);
  void addDepthInfo(const sensor_msgs::CameraInfoConstPtr& info);

  /// What has arrived so far, for the message that says what is missing.
  std::string describeArrivals(const std::array<std::string, 3>& topics) const;

 private:
  using Pointer = boost::shared_ptr<const InputImage>;
  using Policy = message_filters::sync_policies::ApproximateTime<InputImage, InputImage>;
  using Synchronizer = message_filters::Synchronizer<Policy>;
  enum Stream { kColor, kDepth, kInfo, kStreams };

  struct Arrivals {
    std::size_t count = 0;
    ros::Time newest;
  };

  void restart();
  template <int stream>
  void pair(const InputImage& image);
  /// Whether an image of this stamp may go on; `reason` says why not.
  bool admit(Stream stream, const ros::Time& stamp, std::string& reason);
  void onPair(const Pointer& color, const Pointer& depth);
  void handOver(const InputImage& color, const InputImage& depth);
  void giveUp(const std_msgs::Header& header);
  std::size_t kept() const { return static_cast<std::size_t>(settings_.queue_size); }

  PairingSettings settings_;
  Handlers handlers_;
  std::unique_ptr<Synchronizer> synchronizer_;
  std::deque<std_msgs::Header> waiting_;                  // colour images without depth yet
  std::deque<std::pair<Pointer, Pointer>> uncalibrated_;  // pairs before the first camera_info
  CameraInfos infos_, depth_infos_;
  std::array<Arrivals, kStreams> arrivals_;
};

}  // namespace posefusion_ros

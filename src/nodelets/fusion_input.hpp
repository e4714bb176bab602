// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <functional>

#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/bags/messages.hpp"
#include "posefusion_ros/exact_matcher.hpp"

namespace posefusion_ros {

/// The topics that fusion takes, put together by their stamps.
class FusionInput {
 public:
  /// Camera, colour, static depth, mask, flow, blur score, sharp depth.
  using Matcher = ExactMatcher<sensor_msgs::CameraInfo, sensor_msgs::Image, sensor_msgs::Image,
                               sensor_msgs::Image, SparseFlowMsg, BlurScoreMsg, sensor_msgs::Image>;
  using Set = Matcher::Set;

  /// `handler` is called in the callback queue of the handle.
  FusionInput(ros::NodeHandle& handle, Matcher::Handler handler);

  /// Whether the stages before are there.
  bool isConnected() const { return color_.getNumPublishers() > 0 && mask_.getNumPublishers() > 0; }

  /// Of the colour image.
  static const std_msgs::Header& headerOf(const Set& set) { return std::get<1>(set)->header; }

 private:
  template <std::size_t Index>
  ros::Subscriber subscribe(ros::NodeHandle& handle, const char* topic);
  void onBlurScore(const BlurScoreMsg::ConstPtr& score);

  Matcher matcher_;
  ros::Subscriber info_, color_, depth_, mask_, flow_, blur_score_, input_depth_;
};

/// The frame in a set; shares the memory of its messages. Throws InputError naming what cannot be.
pf::StaticFrame toStaticFrame(const FusionInput::Set& set);

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/status_output.hpp"

#include <cstdio>

#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

constexpr int kStatusQueue = 1000;
constexpr double kTextHeight_m = 0.2, kAboveCamera_m = 0.4;
constexpr double kTextPeriod_s = 0.2;

std_msgs::ColorRGBA color(float r, float g, float b) {
  std_msgs::ColorRGBA c;
  c.r = r;
  c.g = g;
  c.b = b;
  c.a = 1;
  return c;
}

}  // namespace

visualization_msgs::Marker toStateText(const TrackingStatusMsg& status, double lost_s) {
  visualization_msgs::Marker text;
  text.header = status.header;
  text.ns = "state";
  text.type = visualization_msgs::Marker::TEXT_VIEW_FACING;
  text.pose.position = status.pose.position;
  text.pose.position.z += kAboveCamera_m;
  text.pose.orientation.w = 1;
  text.scale.z = kTextHeight_m;
  text.frame_locked = 0;
  char lost[48];
  std::snprintf(lost, sizeof lost, "lost for %.0f s", lost_s);
  if (status.outcome == TrackingStatusMsg::PAUSED) {
    text.text = "paused";
    text.color = color(0.7F, 0.7F, 0.7F);
  } else if (status.state == TrackingStatusMsg::LOST) {
    text.text = lost;
    text.color = color(1.0F, 0.25F, 0.2F);
  } else if (status.state == TrackingStatusMsg::DOUBTFUL) {
    text.text = "doubtful";
    text.color = color(1.0F, 0.8F, 0.1F);
  } else if (status.state == TrackingStatusMsg::TRACKING) {
    text.text = "tracking";
    text.color = color(0.2F, 0.9F, 0.3F);
  } else {
    text.text = "waiting for a first frame with depth";
    text.color = color(0.7F, 0.7F, 0.7F);
  }
  return text;
}

void StatusOutput::advertise(ros::NodeHandle& handle) {
  const std::lock_guard<std::mutex> lock(mutex_);
  text_ = handle.advertise<visualization_msgs::Marker>(topics::kStateText, 1, true);
  status_ = handle.advertise<TrackingStatusMsg>(topics::kStatus, kStatusQueue);
}

void StatusOutput::publish(const TrackingStatusMsg& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!status_) return;
  status_.publish(status);
  const ros::Time stamp = status.header.stamp;
  if (status.state != TrackingStatusMsg::LOST || known_.isZero() || stamp < known_) known_ = stamp;
  if (text_.getNumSubscribers() == 0) return;
  visualization_msgs::Marker text = toStateText(status, stamp.toSec() - known_.toSec());
  const double since_s = stamp.toSec() - shown_.header.stamp.toSec();
  if (text.text == shown_.text && since_s >= 0 && since_s < kTextPeriod_s) return;
  text_.publish(text);
  shown_ = text;
}

void StatusOutput::clearText() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!text_ || text_.getNumSubscribers() == 0) return;
  shown_.action = visualization_msgs::Marker::DELETE;
  text_.publish(shown_);
}

}  // namespace posefusion_ros

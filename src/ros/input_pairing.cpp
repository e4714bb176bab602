// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/input_pairing.hpp"

#include <iomanip>
#include <sstream>
#include <utility>

namespace posefusion_ros {
namespace {

std::string seconds(double value) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << value << " s";
  return text.str();
}

}  // namespace

PairingSettings readPairing(Parameters& parameters) {
  PairingSettings s;
  s.queue_size = parameters.integer("queue_size", s.queue_size, {1, 10000});
  s.approximate = parameters.flag("approximate_sync", s.approximate);
  s.max_interval_s = parameters.number("max_interval_s", s.max_interval_s, {0.0, 10.0});
  s.time_jump_threshold_s =
      parameters.number("time_jump_threshold_s", s.time_jump_threshold_s, {0.0, 1e6});
  return s;
}

InputPairing::InputPairing(const PairingSettings& settings, Handlers handlers)
    : settings_(settings), handlers_(std::move(handlers)) {
  restart();
}

void InputPairing::restart() {
  Policy policy(settings_.queue_size);
  policy.setReset(true);
  policy.setMaxIntervalDuration(
      ros::Duration(settings_.approximate ? settings_.max_interval_s : 0));
  synchronizer_ = std::make_unique<Synchronizer>(policy);
  synchronizer_->registerCallback(&InputPairing::onSet, this);
}

bool InputPairing::admit(Stream stream, const ros::Time& stamp, std::string& reason) {
  Arrivals& arrivals = arrivals_[stream];
  ++arrivals.count;
  if (stamp.isZero()) {
    reason = "the stamp is 0";
    return false;
  }
  if (stamp > arrivals.newest) {
    arrivals.newest = stamp;
    return true;
  }
  const double back_s = (arrivals.newest - stamp).toSec();
  if (back_s <= settings_.time_jump_threshold_s) {
    reason = back_s > 0 ? "the stamp went back by " + seconds(back_s)
                        : "the stamp is that of the frame before";
    return false;
  }
  // The first stream that jumps takes the others along: their newest stamps are of the old time.
  for (const std_msgs::Header& header : std::exchange(waiting_, {})) giveUp(header);
  for (Arrivals& each : arrivals_) each.newest = ros::Time();
  arrivals.newest = stamp;
  restart();
  handlers_.jump(back_s);
  return true;
}

void InputPairing::addColor(const sensor_msgs::ImageConstPtr& image) {
  std::string reason;
  if (!admit(kColor, image->header.stamp, reason)) {
    handlers_.unused(image->header, "colour image: " + reason);
    return;
  }
  waiting_.push_back(image->header);
  synchronizer_->add<kColor>(ros::MessageEvent<const sensor_msgs::Image>(image));
  while (waiting_.size() > static_cast<std::size_t>(settings_.queue_size)) {
    const std_msgs::Header oldest = waiting_.front();
    waiting_.pop_front();
    giveUp(oldest);
  }
}

void InputPairing::addDepth(const sensor_msgs::ImageConstPtr& image) {
  std::string reason;
  if (!admit(kDepth, image->header.stamp, reason)) return;
  synchronizer_->add<kDepth>(ros::MessageEvent<const sensor_msgs::Image>(image));
}

void InputPairing::addInfo(const sensor_msgs::CameraInfoConstPtr& info) {
  std::string reason;
  if (!admit(kInfo, info->header.stamp, reason)) return;
  synchronizer_->add<kInfo>(ros::MessageEvent<const sensor_msgs::CameraInfo>(info));
}

void InputPairing::onSet(const sensor_msgs::ImageConstPtr& color,
                         const sensor_msgs::ImageConstPtr& depth,
                         const sensor_msgs::CameraInfoConstPtr& info) {
  while (!waiting_.empty() && waiting_.front().stamp < color->header.stamp) {
    const std_msgs::Header passed = waiting_.front();
    waiting_.pop_front();
    giveUp(passed);
  }
  if (waiting_.empty()) return;  // given up already
  waiting_.pop_front();
  handlers_.set(color, depth, info);
}

void InputPairing::giveUp(const std_msgs::Header& header) {
  const std::string span = settings_.approximate && settings_.max_interval_s > 0
                               ? "within " + seconds(settings_.max_interval_s)
                               : "of the same stamp";
  std::string missing = "depth image and camera_info";
  if (arrivals_[kDepth].count == 0 && arrivals_[kInfo].count > 0) missing = "depth image";
  if (arrivals_[kDepth].count > 0 && arrivals_[kInfo].count == 0) missing = "camera_info";
  handlers_.unused(header, "no " + missing + " " + span);
}

std::string InputPairing::describeArrivals(const std::array<std::string, 3>& topics) const {
  std::ostringstream text;
  text << (settings_.approximate ? "approximate" : "exact") << " sync";
  for (int i = 0; i < kStreams; ++i) {
    text << "; " << topics[i] << ": ";
    if (arrivals_[i].count == 0) {
      text << "nothing";
    } else {
      text << arrivals_[i].count << ", newest stamp " << arrivals_[i].newest;
    }
  }
  return text.str();
}

}  // namespace posefusion_ros

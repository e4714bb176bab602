// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/input_pairing.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace posefusion_ros {
namespace {

std::string seconds(double value) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << value << " s";
  return text.str();
}

}  // namespace

void CameraInfos::add(const sensor_msgs::CameraInfoConstPtr& info, std::size_t kept) {
  infos_.push_back(info);
  while (infos_.size() > kept) infos_.pop_front();
}

sensor_msgs::CameraInfoConstPtr CameraInfos::find(const ros::Time& stamp) const {
  const auto same = std::find_if(infos_.rbegin(), infos_.rend(),
                                 [&](const auto& info) { return info->header.stamp == stamp; });
  if (same != infos_.rend()) return *same;
  return infos_.empty() ? sensor_msgs::CameraInfoConstPtr() : infos_.back();
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
  synchronizer_->registerCallback(&InputPairing::onPair, this);
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
  // Not by ros::Duration: it throws beyond 68 years.
  const double back_s = arrivals.newest.toSec() - stamp.toSec();
  if (back_s <= settings_.time_jump_threshold_s) {
    reason = back_s > 0 ? "the stamp went back by " + seconds(back_s)
                        : "the stamp is that of the frame before";
    return false;
  }
  // The first stream that jumps takes the others along: their newest stamps are of the old time.
  for (const auto& pair : std::exchange(uncalibrated_, {})) giveUp(pair.first->header);
  for (const std_msgs::Header& header : std::exchange(waiting_, {})) giveUp(header);
  for (Arrivals& each : arrivals_) each.newest = ros::Time();
  arrivals.newest = stamp;
  restart();
  handlers_.jump(back_s);
  return true;
}

void InputPairing::addColor(const InputImage& image) {
  std::string reason;
  if (!admit(kColor, image.header.stamp, reason)) {
    handlers_.unused(image.header, "colour image: " + reason);
    return;
  }
  waiting_.push_back(image.header);
  pair<kColor>(image);
  while (waiting_.size() > kept()) {
    const std_msgs::Header oldest = waiting_.front();
    waiting_.pop_front();
    giveUp(oldest);
  }
}

void InputPairing::addDepth(const InputImage& image) {
  std::string reason;
  if (!admit(kDepth, image.header.stamp, reason)) return;
  pair<kDepth>(image);
}

template <int stream>
void InputPairing::pair(const InputImage& image) {
  try {
    synchronizer_->add<stream>(
        ros::MessageEvent<const InputImage>(boost::make_shared<const InputImage>(image)));
  } catch (const std::runtime_error&) {
    // It takes differences of stamps, which throw beyond 68 years.
    for (const std_msgs::Header& header : std::exchange(waiting_, {})) giveUp(header);
    restart();
  }
}

// Any stamp will do, 0 and old ones too: it may have been sent once.
void InputPairing::addInfo(const sensor_msgs::CameraInfoConstPtr& info) {
  ++arrivals_[kInfo].count;
  arrivals_[kInfo].newest = info->header.stamp;
  infos_.add(info, kept());
  for (const auto& [color, depth] : std::exchange(uncalibrated_, {})) handOver(*color, *depth);
}

void InputPairing::addDepthInfo(const sensor_msgs::CameraInfoConstPtr& info) {
  depth_infos_.add(info, kept());
}

void InputPairing::onPair(const Pointer& color, const Pointer& depth) {
  while (!waiting_.empty() && waiting_.front().stamp < color->header.stamp) {
    const std_msgs::Header passed = waiting_.front();
    waiting_.pop_front();
    giveUp(passed);
  }
  if (waiting_.empty()) return;  // given up already
  waiting_.pop_front();
  if (arrivals_[kInfo].count > 0) return handOver(*color, *depth);
  uncalibrated_.emplace_back(color, depth);
  if (uncalibrated_.size() <= kept()) return;
  const std_msgs::Header oldest = uncalibrated_.front().first->header;
  uncalibrated_.pop_front();
  giveUp(oldest);
}

void InputPairing::handOver(const InputImage& color, const InputImage& depth) {
  handlers_.set(
      {color, depth, infos_.find(color.header.stamp), depth_infos_.find(depth.header.stamp)});
}

void InputPairing::giveUp(const std_msgs::Header& header) {
  const std::string span = settings_.approximate && settings_.max_interval_s > 0
                               ? "within " + seconds(settings_.max_interval_s)
                               : "of the same stamp";
  const bool no_info = arrivals_[kInfo].count == 0;
  const bool no_depth = arrivals_[kDepth].count == 0;
  handlers_.unused(header, no_info && !no_depth
                               ? "no camera_info has come yet"
                               : "no depth image " + span + (no_info ? " and no camera_info" : ""));
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

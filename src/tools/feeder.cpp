// SPDX-License-Identifier: BSD-3-Clause
// posefusion_feeder: plays a recording into the chain, lossless or in real time, and ends when the
// last frame has been reported. Reports what became of the frames, and how long transforms took.
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "chain_presence.hpp"
#include "feeder_settings.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/credit_window.hpp"
#include "posefusion_ros/latency.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/node_control.hpp"
#include "posefusion_ros/replay_progress.hpp"
#include "posefusion_ros/transform_replay.hpp"
#include "posefusion_ros/transforms.hpp"
#include "replay_report.hpp"

namespace posefusion_ros {
namespace {

using pf::InputError;
using std::chrono::duration;
using std::chrono::steady_clock;

// In real time the chain may lose a frame without a word; silence then ends the replay.
constexpr double kQuiet_s = 5.0;
constexpr int kQueue = 100;
constexpr double kEndPatience_s = 60;   // a large map takes its time to be saved
constexpr double kStayPatience_s = 10;  // until rviz is there

class Feeder {
 public:
  Feeder(const std::string& input, const FeederSettings& settings)
      : settings_(settings),
        chain_(settings.manager),
        source_(openInput(input, settings.input)),
        spinner_(1) {
    if (settings_.frame_id.empty()) {
      settings_.frame_id = plainFrame(recordedFrameId(input, settings.input.topics));
    }
    if (settings_.frame_id.empty()) settings_.frame_id = frames::kOptical;
    if (settings.tf) transforms_ = std::make_unique<TransformReplay>(handle_, input);
    if (settings.clock) clock_ = handle_.advertise<rosgraph_msgs::Clock>("/clock", kQueue);
    info_ = handle_.advertise<sensor_msgs::CameraInfo>(topics::kCameraInfo, kQueue);
    depth_ = handle_.advertise<sensor_msgs::Image>(topics::kDepth, kQueue);
    color_ = handle_.advertise<sensor_msgs::Image>(topics::kColor, kQueue);
    status_ = handle_.subscribe(topics::kStatus, 1000, &Feeder::onStatus, this);
    if (!settings.lossless && !settings.tf) {
      tf_ = handle_.subscribe("/tf", 1000, &Feeder::onTransforms, this);
    }
    if (!settings.output.empty()) {
      report_ = std::make_unique<ReplayReport>(handle_, settings.config, settings.output,
                                               source_->truth());
    }
    spinner_.start();
  }

  /// Throws InputError when the chain does not take or report the frames.
  void run() {
    waitForChain();
    const steady_clock::time_point begin = steady_clock::now();
    const auto most = static_cast<std::size_t>(settings_.max_frames);
    const std::size_t total = source_->frameCount();
    ReplayProgress progress(most > 0 ? std::min(most, total) : total, begin);
    std::int64_t first_ns = -1;
    while (ros::ok() && (settings_.max_frames == 0 || sent_ < settings_.max_frames)) {
      const auto next = source_->next();
      if (!next) break;
      if (!next->defect.empty()) {
        ++unreadable_;
        ROS_WARN("left out: %s", next->defect.c_str());
        continue;
      }
      const std::int64_t stamp_ns = next->frame.stamp_ns;
      if (first_ns < 0) first_ns = stamp_ns;
      if (settings_.lossless) {
        if (!waitBelow(settings_.window, settings_.timeout_s)) fail();
        if (!ros::ok()) break;
      } else {
        const duration<double> due(static_cast<double>(stamp_ns - first_ns) * 1e-9 /
                                   settings_.rate);
        std::this_thread::sleep_until(begin +
                                      std::chrono::duration_cast<steady_clock::duration>(due));
      }
      send(next->frame);
      const std::string line = progress.after(static_cast<std::size_t>(sent_), steady_clock::now());
      if (!line.empty()) ROS_INFO("%s", line.c_str());
    }
    const double patience_s = settings_.lossless ? settings_.timeout_s : kQuiet_s;
    if (!waitBelow(1, patience_s) && settings_.lossless) fail();
  }

  /// Once fusion has saved. Throws InputError where it has not.
  void writeReport() {
    if (report_) ROS_INFO("%s", report_->write().c_str());
  }

  std::string summary() const {
    std::ostringstream text;
    text << sent_ << " frames sent";
    for (const auto& [reason, count] : outcomes_) text << ", " << count << " " << reason;
    if (window_.underWay() > 0) text << ", " << window_.underWay() << " without a status";
    if (latency_.count() > 0) {
      text << std::fixed << std::setprecision(1) << "; from frame to TF "
           << 1e3 * latency_.quantile(0.5) << " ms median, " << 1e3 * latency_.quantile(0.99)
           << " ms 99 %";
    }
    if (unreadable_ > 0) text << ", " << unreadable_ << " unreadable ones left out";
    return text.str();
  }

 private:
  void waitForChain() {
    const auto end = steady_clock::now() + duration<double>(settings_.timeout_s);
    while (ros::ok()) {
      std::string missing;
      for (const ros::Publisher* topic : {&color_, &depth_, &info_}) {
        if (topic->getNumSubscribers() == 0) missing += " a subscriber of " + topic->getTopic();
      }
      if (status_.getNumPublishers() == 0) missing += " a publisher of " + status_.getTopic();
      if (missing.empty()) return;
      requireChain();
      if (steady_clock::now() > end) {
        throw InputError("waited " + std::to_string(settings_.timeout_s) + " s in vain for" +
                         missing + ": is the chain running?");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  /// False when nothing was reported for so long; Ctrl-C ends the wait.
  bool waitBelow(std::size_t limit, double patience_s) {
    const auto alive = [this] { return ros::ok() && chain_.isUp(); };
    const bool below = window_.waitBelow(limit, duration<double>(patience_s), alive);
    requireChain();
    return below || !ros::ok();
  }

  void requireChain() {
    if (ros::ok() && !chain_.isUp()) throw InputError("the chain has ended: " + summary());
  }

  void send(const pf::RgbdFrame& frame) {
    std_msgs::Header header;
    header.stamp = toTime(frame.stamp_ns);
    header.frame_id = settings_.frame_id;
    if (transforms_) transforms_->advance(header.stamp);
    rosgraph_msgs::Clock clock;
    clock.clock = header.stamp;
    if (settings_.clock) clock_.publish(clock);
    latency_.sent(frame.stamp_ns, steady_clock::now());
    window_.sent(frame.stamp_ns);
    ++sent_;
    if (report_) report_->sent(frame);
    info_.publish(toCameraInfo(frame.camera, header));
    depth_.publish(toDepthImage(frame, header));
    color_.publish(toImage(frame.color, "rgb8", header));
  }

  void onStatus(const TrackingStatusMsg::ConstPtr& status) {
    const bool is_dropped = status->outcome == TrackingStatusMsg::DROPPED;
    const std::string name = is_dropped ? status->reason : outcomeName(status->outcome);
    {
      const std::lock_guard<std::mutex> lock(outcome_mutex_);
      ++outcomes_[name];
    }
    if (report_) report_->reported(*status);
    if (!window_.reported(toNs(status->header.stamp))) {
      ROS_WARN("a status for stamp %u.%09u, of which no frame is under way",
               status->header.stamp.sec, status->header.stamp.nsec);
    }
  }

  void onTransforms(const tf2_msgs::TFMessage::ConstPtr& message) {
    for (const auto& transform : message->transforms) {
      latency_.arrived(toNs(transform.header.stamp), steady_clock::now());
    }
  }

  [[noreturn]] void fail() const {
    throw InputError("no status on " + status_.getTopic() + " for " +
                     std::to_string(settings_.timeout_s) + " s: " + summary());
  }

  FeederSettings settings_;
  ChainPresence chain_;
  std::unique_ptr<pf::FrameSource> source_;
  ros::NodeHandle handle_;
  std::unique_ptr<TransformReplay> transforms_;
  std::unique_ptr<ReplayReport> report_;
  CreditWindow window_;
  LatencyMeter latency_;
  int sent_ = 0;
  int unreadable_ = 0;
  std::mutex outcome_mutex_;
  std::map<std::string, int> outcomes_;
  ros::Publisher clock_, info_, depth_, color_;
  ros::Subscriber status_, tf_;
  ros::AsyncSpinner spinner_;
};

/// After the last frame. Not by `required` in the launch file: roslaunch calls a normal end an
/// error then.
void endLaunch(const FeederSettings& settings, Feeder& feeder) {
  std::vector<std::string> nodes = settings.ends;
  nodes.push_back(settings.manager);
  endNodes(nodes, kEndPatience_s);
  feeder.writeReport();
  if (settings.stays.empty()) return;
  ROS_INFO("all is done; close %s to end", settings.stays.c_str());
  outwait(settings.stays, kStayPatience_s);
}

/// The exit code.
int feed(const std::string& input) {
  int code = 1;
  try {
    const FeederSettings settings = readFeederSettings();
    Feeder feeder(input, settings);
    feeder.run();
    ROS_INFO("%s", feeder.summary().c_str());
    if (ros::ok()) endLaunch(settings, feeder);
    code = 0;
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
  }
  if (ros::ok()) endRoslaunch();
  return code;
}

}  // namespace
}  // namespace posefusion_ros

int main(int argc, char** argv) {
  ros::init(argc, argv, "posefusion_feeder");
  if (argc != 2) {
    std::cerr << "usage: posefusion_feeder BAG_OR_TUM_FOLDER [_lossless:=true] [_rate:=1.0]\n";
    return 2;
  }
  const ros::NodeHandle alive;  // ROS, and with it the log, ends with the last handle
  return posefusion_ros::feed(argv[1]);
}

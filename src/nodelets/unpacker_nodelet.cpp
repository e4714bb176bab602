// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <chrono>
#include <memory>
#include <string>

#include "posefusion/core/error.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/clock_watch.hpp"
#include "posefusion_ros/compressed_frame.hpp"
#include "posefusion_ros/link_renewal.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/stamp_guard.hpp"
#include "posefusion_ros/topic_hints.hpp"

namespace posefusion_ros {

/// Publishes what a packer sends from another machine as the topics of a camera. What cannot be
/// used is given up, which fusion reports as it does for frames that the gate gives up.
class UnpackerNodelet : public ChainNodelet {
 public:
  ~UnpackerNodelet() override {
    subscriber_.shutdown();
    renewal_.reset();
  }

 private:
  void start() override {
    ros::NodeHandle& handle = getNodeHandle();
    Parameters parameters(getPrivateNodeHandle());
    const std::string topic = parameters.text("frame_topic", topics::kCompressedFrameOfRobot);
    max_interval_s_ = parameters.number("max_interval_s", 0.02, {0.0, 10.0});
    guard_ =
        std::make_unique<StampGuard>(parameters.number("time_jump_threshold_s", 1.0, {0.0, 1e6}));
    const double silent_s = parameters.number("renew_after_s", 0.5, {0.0, 1e6});
    missing_after_s_ = parameters.number("missing_after_s", 5.0, {0.1, 1e6});
    report(parameters);

    constexpr int kQueue = 10;
    depth_info_publisher_ =
        handle.advertise<sensor_msgs::CameraInfo>(topics::kDepthCameraInfo, kQueue);
    info_publisher_ = handle.advertise<sensor_msgs::CameraInfo>(topics::kCameraInfo, kQueue);
    depth_publisher_ = handle.advertise<sensor_msgs::Image>(topics::kDepth, kQueue);
    color_publisher_ = handle.advertise<sensor_msgs::Image>(topics::kColor, kQueue);
    timer_ = handle.createWallTimer(ros::WallDuration(missing_after_s_),
                                    &UnpackerNodelet::tellMissing, this);
    if (silent_s > 0.0) {
      renewal_ = std::make_unique<LinkRenewal>(handle.resolveName(topic), silent_s,
                                               [this] { NODELET_WARN("%s", kRenewed); });
    }
    // Of what waits, after a cut or on a busy machine, only the newest is of use.
    subscriber_ = handle.subscribe(topic, 2, &UnpackerNodelet::onFrame, this,
                                   ros::TransportHints().tcpNoDelay());
  }

  void onFrame(const ros::MessageEvent<const CompressedFrameMsg>& event) {
    heard_since_look_ = true;
    if (renewal_) renewal_->heard(event.getPublisherName());
    const CompressedFrameMsg::ConstPtr frame = event.getConstMessage();
    try {
      const std::string defect =
          guard_->defectOf(toNs(frame->header.stamp), std::chrono::steady_clock::now());
      if (!defect.empty()) throw pf::InputError(defect);
      publish(unpackFrame(frame, max_interval_s_));
    } catch (const std::exception& error) {
      return reject(frame->header, TrackingStatusMsg::BAD_INPUT,
                    subscriber_.getTopic() + ": " + error.what());
    }
    passed(frame->header.stamp);
  }

  void publish(const UnpackedFrame& frame) {
    depth_info_publisher_.publish(sensor_msgs::CameraInfoConstPtr(frame.depth_info));
    info_publisher_.publish(sensor_msgs::CameraInfoConstPtr(frame.info));
    depth_publisher_.publish(sensor_msgs::ImageConstPtr(frame.depth));
    color_publisher_.publish(sensor_msgs::ImageConstPtr(frame.color));
  }

  void tellMissing(const ros::WallTimerEvent&) {
    const bool missing = !heard_since_look_;
    heard_since_look_ = false;
    if (!pause_.isDue(std::chrono::steady_clock::now(), missing ? "missing" : "")) return;
    const std::string topic = subscriber_.getTopic();
    const std::string hint =
        subscriber_.getNumPublishers() > 0
            ? "its publisher is there: see its log, and whether the link is"
            : "it has no publisher" +
                  topicHint({topic, "posefusion/CompressedFrame"}, getNodeHandle().getNamespace());
    NODELET_WARN("nothing on %s for %.0f s (%s)", topic.c_str(), missing_after_s_, hint.c_str());
  }

  static constexpr char kRenewed[] =
      "frames stopped, and the machine that sends them can be reached: connected anew";

  double max_interval_s_ = 0.02;
  double missing_after_s_ = 5.0;
  bool heard_since_look_ = false;
  GrowingPause pause_;
  std::unique_ptr<StampGuard> guard_;
  std::unique_ptr<LinkRenewal> renewal_;
  ros::Publisher depth_info_publisher_, info_publisher_, depth_publisher_, color_publisher_;
  ros::WallTimer timer_;
  ros::Subscriber subscriber_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::UnpackerNodelet, nodelet::Nodelet)

// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <boost/make_shared.hpp>
#include <chrono>
#include <memory>
#include <string>

#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/clock_watch.hpp"
#include "posefusion_ros/compressed_frame.hpp"
#include "posefusion_ros/image_subscriber.hpp"
#include "posefusion_ros/input_pairing.hpp"
#include "posefusion_ros/input_settings.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/stamp_guard.hpp"

namespace posefusion_ros {

using sensor_msgs::CameraInfoConstPtr;

/// Sends colour, depth and camera_info of a frame as one compressed message. At most one waits to
/// be sent: what a slow network does not take is replaced by the next.
class PackerNodelet : public ChainNodelet {
 private:
  void start() override {
    ros::NodeHandle& handle = getNodeHandle();
    Parameters parameters(getPrivateNodeHandle());
    input_ = readInput(parameters);
    rate_ = std::make_unique<RateLimit>(parameters.number("rate_hz", 15.0, {0.1, 1000.0}));
    jpeg_quality_ = parameters.integer("jpeg_quality", 80, {1, 100});
    missing_after_s_ = parameters.number("missing_after_s", 5.0, {0.1, 1e6});
    report(parameters);

    InputPairing::Handlers handlers;
    handlers.set = [this](const InputPairing::Set& set) {
      guarded(set.color.header, [&] { onSet(set); });
    };
    handlers.unused = [this](const std_msgs::Header& header, const std::string& reason) {
      reject(header, TrackingStatusMsg::BAD_INPUT, reason + origin_);
    };
    handlers.jump = [this](double seconds) { NODELET_WARN("stamps went back by %.3f s", seconds); };
    pairing_ = std::make_unique<InputPairing>(input_.pairing, std::move(handlers));
    publisher_ = handle.advertise<CompressedFrameMsg>(topics::kCompressedFrame, 1);
    timer_ = handle.createWallTimer(ros::WallDuration(missing_after_s_),
                                    &PackerNodelet::tellMissing, this);
    subscribe(handle);
  }

  void subscribe(ros::NodeHandle& handle) {
    const int queue = input_.pairing.queue_size;
    origin_ = " (colour " + handle.resolveName(input_.color_topic) + ", depth " +
              handle.resolveName(input_.depth_topic) + ", camera_info " +
              handle.resolveName(input_.camera_info_topic) + ")";
    color_ = ImageSubscriber(handle, {input_.color_topic, input_.image_transport, queue, 0.0},
                             [this](const InputImage& image) { pairing_->addColor(image); });
    depth_ = ImageSubscriber(
        handle, {input_.depth_topic, input_.depthTransport(), queue, input_.depth_stamp_offset_s},
        [this](const InputImage& image) { pairing_->addDepth(image); });
    info_ = handle.subscribe(input_.camera_info_topic, queue, &PackerNodelet::onInfo, this);
    depth_info_ =
        handle.subscribe(input_.depth_camera_info_topic, queue, &PackerNodelet::onDepthInfo, this);
  }

  void onInfo(const CameraInfoConstPtr& info) { pairing_->addInfo(info); }
  void onDepthInfo(const CameraInfoConstPtr& info) { pairing_->addDepthInfo(info); }

  void onSet(const InputPairing::Set& set) {
    sets_since_look_ = true;
    const auto listeners = publisher_.getNumSubscribers();
    watch().set("listeners", std::to_string(listeners));
    // Nothing is worked out that nobody hears; that it is not sent is no fault.
    if (listeners == 0 || !rate_->lets(set.color.stamp_ns)) {
      watch().givenUp(std::chrono::steady_clock::now(), TrackingStatusMsg::PAUSED);
      return;
    }
    try {
      const auto frame = boost::make_shared<const CompressedFrameMsg>(
          packFrame(set, input_.depth_unit_m, jpeg_quality_));
      watch().set("bytes of the last frame",
                  std::to_string(frame->color.data.size() + frame->depth.data.size()));
      publisher_.publish(frame);
    } catch (const std::exception& error) {
      return reject(set.color.header, TrackingStatusMsg::BAD_INPUT, error.what() + origin_);
    }
    passed(set.color.header.stamp);
  }

  void tellMissing(const ros::WallTimerEvent&) {
    const bool missing = !sets_since_look_;
    sets_since_look_ = false;
    if (!pause_.isDue(std::chrono::steady_clock::now(), missing ? "missing" : "")) return;
    NODELET_WARN(
        "no complete frame for %.0f s. %s", missing_after_s_,
        pairing_->describeArrivals({color_.topic(), depth_.topic(), info_.getTopic()}).c_str());
  }

  InputSettings input_;
  int jpeg_quality_ = 80;
  double missing_after_s_ = 5.0;
  std::string origin_;  ///< of the frames, for messages
  std::unique_ptr<RateLimit> rate_;
  bool sets_since_look_ = false;
  GrowingPause pause_;
  std::unique_ptr<InputPairing> pairing_;
  ros::Publisher publisher_;
  ImageSubscriber color_, depth_;
  ros::Subscriber info_, depth_info_;
  ros::WallTimer timer_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::PackerNodelet, nodelet::Nodelet)

// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <boost/make_shared.hpp>
#include <chrono>
#include <memory>
#include <string>

#include "posefusion_ros/camera_topics.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/clock_watch.hpp"
#include "posefusion_ros/compressed_frame.hpp"
#include "posefusion_ros/input_pairing.hpp"
#include "posefusion_ros/input_settings.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/stamp_guard.hpp"

namespace posefusion_ros {

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
      reject(header, TrackingStatusMsg::BAD_INPUT, reason + topics_.origin());
    };
    handlers.jump = [this](double seconds) { NODELET_WARN("stamps went back by %.3f s", seconds); };
    pairing_ = std::make_unique<InputPairing>(input_.pairing, std::move(handlers));
    publisher_ = handle.advertise<CompressedFrameMsg>(topics::kCompressedFrame, 1);
    timer_ = handle.createWallTimer(ros::WallDuration(missing_after_s_),
                                    &PackerNodelet::tellMissing, this);
    topics_.subscribe(handle, input_, *pairing_);
  }

  void onSet(const InputPairing::Set& set) {
    sets_since_look_ = true;
    const auto listeners = publisher_.getNumSubscribers();
    watch().set("listeners", std::to_string(listeners));
    // Without subscribers nothing is packed, which is no fault.
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
      return reject(set.color.header, TrackingStatusMsg::BAD_INPUT,
                    error.what() + topics_.origin());
    }
    passed(set.color.header.stamp);
  }

  void tellMissing(const ros::WallTimerEvent&) {
    const bool missing = !sets_since_look_;
    sets_since_look_ = false;
    if (!pause_.isDue(std::chrono::steady_clock::now(), missing ? "missing" : "")) return;
    const std::string arrivals = pairing_->describeArrivals(
        {topics_.color().topic(), topics_.depth().topic(), topics_.info().getTopic()});
    NODELET_WARN("no complete frame for %.0f s. %s", missing_after_s_, arrivals.c_str());
  }

  InputSettings input_;
  int jpeg_quality_ = 80;
  double missing_after_s_ = 5.0;
  std::unique_ptr<RateLimit> rate_;
  bool sets_since_look_ = false;
  GrowingPause pause_;
  std::unique_ptr<InputPairing> pairing_;
  ros::Publisher publisher_;
  CameraTopics topics_;
  ros::WallTimer timer_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::PackerNodelet, nodelet::Nodelet)

// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <boost/make_shared.hpp>
#include <memory>

#include "posefusion/blur/gate.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/conversions.hpp"
#include "posefusion_ros/input_pairing.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/running_settings.hpp"
#include "posefusion_ros/settings_server.hpp"
#include "posefusion_ros/topic_hints.hpp"
#include "posefusion_ros/transforms.hpp"

namespace posefusion_ros {

using sensor_msgs::CameraInfoConstPtr;
using sensor_msgs::ImageConstPtr;

/// Pairs the camera's topics, checks and rectifies them, and lets sharp frames pass: the very same
/// messages where nothing had to be changed. Everything in one serial callback queue.
class BlurGateNodelet : public ChainNodelet {
 private:
  void start() override {
    ros::NodeHandle& handle = getNodeHandle();
    Parameters parameters(getPrivateNodeHandle());
    config_ = parameters.config({"blur"}).blur;
    const PairingSettings pairing = readPairing(parameters);
    rectified_ = parameters.choice("input_rectified", "auto", {"auto", "yes", "no"});
    require_same_frame_ = parameters.flag("require_same_frame", true);
    missing_after_s_ = parameters.number("missing_after_s", 5.0, {0.1, 1e6});
    report(parameters);

    gate_ = std::make_unique<pf::BlurGate>(config_);
    InputPairing::Handlers handlers;
    handlers.set = [this](const auto& color, const auto& depth, const auto& info) {
      guarded(color->header, [&] { onSet(color, depth, info); });
    };
    handlers.unused = [this](const std_msgs::Header& header, const std::string& reason) {
      reject(header, TrackingStatusMsg::BAD_INPUT, reason);
    };
    handlers.jump = [this](double seconds) {
      NODELET_WARN("stamps went back by %.3f s: the chain begins anew", seconds);
      gate_->reset();
    };
    pairing_ = std::make_unique<InputPairing>(pairing, std::move(handlers));

    const int queue = pairing.queue_size;
    score_publisher_ = handle.advertise<BlurScoreMsg>(topics::kBlurScore, queue);
    info_publisher_ = handle.advertise<sensor_msgs::CameraInfo>(topics::kSharpCameraInfo, queue);
    depth_publisher_ = handle.advertise<sensor_msgs::Image>(topics::kSharpDepth, queue);
    color_publisher_ = handle.advertise<sensor_msgs::Image>(topics::kSharpColor, queue);
    // In the queue of the frames: a change falls between two of them.
    settings_ = std::make_unique<SettingsServer<GateSettings>>(
        getPrivateNodeHandle(), GateSettings{config_},
        [this](const GateSettings& settings) { gate_->set(settings.blur); });
    timer_ = handle.createWallTimer(ros::WallDuration(missing_after_s_),
                                    &BlurGateNodelet::tellMissing, this);
    color_ = handle.subscribe(topics::kColor, queue, &BlurGateNodelet::onColor, this);
    depth_ = handle.subscribe(topics::kDepth, queue, &BlurGateNodelet::onDepth, this);
    info_ = handle.subscribe(topics::kCameraInfo, queue, &BlurGateNodelet::onInfo, this);
    if (rectified_ == "auto") {
      rectified_ = color_.getTopic().find("_rect") != std::string::npos ? "yes" : "no";
    }
  }

  void onColor(const ImageConstPtr& image) { pairing_->addColor(image); }
  void onDepth(const ImageConstPtr& image) { pairing_->addDepth(image); }
  void onInfo(const CameraInfoConstPtr& info) { pairing_->addInfo(info); }

  void onSet(const ImageConstPtr& color, const ImageConstPtr& depth,
             const CameraInfoConstPtr& info) {
    sets_since_look_ = true;
    const std::string color_frame = plainFrame(color->header.frame_id);
    const std::string depth_frame = plainFrame(depth->header.frame_id);
    if (require_same_frame_ && color_frame != depth_frame) {
      throw pf::InputError("colour is in frame '" + color_frame + "' but depth in '" + depth_frame +
                           "', expected depth registered to colour");
    }
    const pf::PinholeCamera camera = toCamera(*info, rectified_ == "yes");
    const pf::RgbdFrame frame = toFrame(color, depth, camera);
    const pf::RgbdFrame straight = rectifier_.rectify(frame);
    const pf::BlurScore blur = gate_->judge(pf::measureSharpness(straight.color));
    publishScore(color->header, blur);
    if (!blur.sharp) {
      reject(
          color->header, TrackingStatusMsg::BLURRED,
          "blurred: " + std::to_string(blur.measure) + " below " + std::to_string(blur.threshold));
      return;
    }
    pass(straight, color, depth);
  }

  void publishScore(const std_msgs::Header& header, const pf::BlurScore& blur) {
    BlurScoreMsg message;
    message.header = header;
    message.score = blur.score;
    message.measure = blur.measure;
    message.threshold = blur.threshold;
    message.sharp = static_cast<unsigned char>(blur.sharp);
    message.forced = static_cast<unsigned char>(blur.forced);
    score_publisher_.publish(message);
  }

  /// The stamp of the colour image names the frame from here on: depth takes it too.
  void pass(const pf::RgbdFrame& frame, const ImageConstPtr& color, const ImageConstPtr& depth) {
    const std_msgs::Header& header = color->header;
    const bool same_color = frame.color.data == color->data.data();
    const bool same_depth =
        frame.depth.data == depth->data.data() && depth->header.stamp == header.stamp;
    info_publisher_.publish(
        boost::make_shared<const sensor_msgs::CameraInfo>(toCameraInfo(frame.camera, header)));
    depth_publisher_.publish(
        same_depth ? depth : ImageConstPtr(toImage(frame.depth, depth->encoding, header)));
    color_publisher_.publish(same_color ? color
                                        : ImageConstPtr(toImage(frame.color, "rgb8", header)));
    passed(header.stamp);
  }

  void tellMissing(const ros::WallTimerEvent&) {
    if (!sets_since_look_) {
      NODELET_WARN("no complete frame for %.0f s. %s", missing_after_s_,
                   pairing_
                       ->describeArrivals({topicText(color_, "sensor_msgs/Image"),
                                           topicText(depth_, "sensor_msgs/Image"),
                                           topicText(info_, "sensor_msgs/CameraInfo")})
                       .c_str());
    }
    sets_since_look_ = false;
  }

  /// The topic, and where nobody publishes it, which ones could be meant.
  std::string topicText(const ros::Subscriber& topic, const std::string& type) const {
    const std::string name = topic.getTopic();
    if (topic.getNumPublishers() > 0) return name;
    return name + " (nobody publishes it" +
           topicHint({name, type}, getNodeHandle().getNamespace()) + ")";
  }

  pf::BlurConfig config_;
  std::string rectified_;
  bool require_same_frame_ = true;
  double missing_after_s_ = 5.0;
  bool sets_since_look_ = false;
  pf::Rectifier rectifier_;
  std::unique_ptr<pf::BlurGate> gate_;
  std::unique_ptr<InputPairing> pairing_;
  ros::Publisher score_publisher_, info_publisher_, depth_publisher_, color_publisher_;
  ros::Subscriber color_, depth_, info_;
  ros::WallTimer timer_;
  std::unique_ptr<SettingsServer<GateSettings>> settings_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::BlurGateNodelet, nodelet::Nodelet)

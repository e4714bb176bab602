// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <boost/make_shared.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "posefusion/blur/gate.hpp"
#include "posefusion/calibration/color_learner.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/camera_file.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/camera_topics.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/clock_watch.hpp"
#include "posefusion_ros/input_pairing.hpp"
#include "posefusion_ros/input_settings.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/running_settings.hpp"
#include "posefusion_ros/settings_server.hpp"
#include "posefusion_ros/topic_hints.hpp"
#include "posefusion_ros/transforms.hpp"

namespace posefusion_ros {

using sensor_msgs::ImageConstPtr;

/// Pairs the camera's topics, checks and rectifies them, and lets sharp frames pass: the very same
/// messages where nothing had to be changed. Everything in one serial callback queue.
class BlurGateNodelet : public ChainNodelet {
 private:
  void start() override {
    ros::NodeHandle& handle = getNodeHandle();
    Parameters parameters(getPrivateNodeHandle());
    const pf::Config config = parameters.config({"blur", "calibration"});
    config_ = config.blur;
    readColor(config.calibration, parameters.text("color_camera_file", ""));
    input_ = readInput(parameters);
    missing_after_s_ = parameters.number("missing_after_s", 5.0, {0.1, 1e6});
    report(parameters);

    gate_ = std::make_unique<pf::BlurGate>(config_);
    InputPairing::Handlers handlers;
    handlers.set = [this](const InputPairing::Set& set) {
      guarded(set.color.header, [&] { onSet(set); });
    };
    handlers.unused = [this](const std_msgs::Header& header, const std::string& reason) {
      reject(header, TrackingStatusMsg::BAD_INPUT, reason);
    };
    handlers.jump = [this](double seconds) {
      NODELET_WARN("stamps went back by %.3f s", seconds);
      gate_->reset();
    };
    pairing_ = std::make_unique<InputPairing>(input_.pairing, std::move(handlers));

    const int queue = input_.pairing.queue_size;
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
    subscribe(handle);
  }

  void subscribe(ros::NodeHandle& handle) {
    // Before the first frame comes: the raw name counts, remapped.
    is_rectified_ = input_.input_rectified == "yes" ||
                    (input_.input_rectified == "auto" &&
                     handle.resolveName(input_.color_topic).find("_rect") != std::string::npos);
    topics_.subscribe(handle, input_, *pairing_);
  }

  void onSet(const InputPairing::Set& set) {
    sets_since_look_ = true;
    const std_msgs::Header& header = set.color.header;
    clock_defect_ = clockDefect(header.stamp, ros::Time::now(), ros::Time::isSimTime());
    const std::string color_frame = plainFrame(header.frame_id);
    const std::string depth_frame = plainFrame(set.depth.header.frame_id);
    if (input_.require_same_frame && color_frame != depth_frame) {
      throw pf::InputError("colour is in frame '" + color_frame + "' but depth in '" + depth_frame +
                           "', expected depth registered to colour");
    }
    const pf::RgbdFrame straight = rectifier_.rectify(frameOf(set));
    const pf::BlurScore blur =
        gate_->judge(pf::measureSharpness(straight.color), straight.stamp_ns);
    publishScore(header, blur);
    if (!blur.sharp) {
      reject(
          header, TrackingStatusMsg::BLURRED,
          "blurred: " + std::to_string(blur.measure) + " below " + std::to_string(blur.threshold));
      return;
    }
    pass(registered(straight), set);
  }

  void readColor(const pf::CalibrationConfig& config, const std::string& file) {
    color_ = pf::ColorLearner(config);
    registers_color_ = config.registersColor();
    if (file.empty()) return;
    const pf::CameraFile camera = pf::loadCamera(file);
    if (!camera.color) {
      throw pf::InputError(file + ": color_fx is missing, expected the colour camera");
    }
    color_.give(*camera.color);
    depth_camera_ = camera.camera.withoutDistortion();
    color_file_ = file;
  }

  /// With colour that lies over depth, as far as its camera is known.
  pf::RgbdFrame registered(const pf::RgbdFrame& frame) {
    if (depth_camera_ && !pf::isSameCamera(*depth_camera_, frame.camera)) {
      throw pf::InputError(color_file_ + ": is of depth by a camera of " +
                           pf::describe(*depth_camera_) + ", but the frame is by one of " +
                           pf::describe(frame.camera));
    }
    const bool was_known = color_.estimate().has_value();
    pf::RgbdFrame out = color_.registered(frame);
    const auto& found = color_.estimate();
    if (!was_known && found && found->doubt.empty()) {
      NODELET_WARN("colour is %.0f px off depth, as of a camera with %s; %s", found->offset_px,
                   pf::describe(found->camera).c_str(),
                   registers_color_ ? "it is registered from now on"
                                    : "calibration: {color: learn} in config:=FILE registers it");
    }
    return out;
  }

  pf::RgbdFrame frameOf(const InputPairing::Set& set) const {
    try {
      InputCamera camera;
      camera.color = toCamera(*set.info, is_rectified_);
      camera.depth_info = set.depth_info;
      camera.rectified = is_rectified_;
      camera.depth_unit_m = input_.depth_unit_m;
      return toFrame(set.color, set.depth, camera);
    } catch (const pf::InputError& error) {
      throw pf::InputError(error.what() + topics_.origin());
    }
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
  void pass(const pf::RgbdFrame& frame, const InputPairing::Set& set) {
    const std_msgs::Header& header = set.color.header;
    const ImageConstPtr color = set.color.raw(), depth = set.depth.raw();
    const bool same_color = color && frame.color.data == color->data.data();
    const bool same_depth = depth && frame.depth.data == depth->data.data() &&
                            depth->header.stamp == header.stamp && frame.depth_unit_m == 1e-3;
    info_publisher_.publish(
        boost::make_shared<const sensor_msgs::CameraInfo>(toCameraInfo(frame.camera, header)));
    depth_publisher_.publish(same_depth ? depth : ImageConstPtr(toDepthImage(frame, header)));
    color_publisher_.publish(same_color ? color
                                        : ImageConstPtr(toImage(frame.color, "rgb8", header)));
    passed(header.stamp);
  }

  void tellMissing(const ros::WallTimerEvent&) {
    const auto now = std::chrono::steady_clock::now();
    std::string topics;
    if (!sets_since_look_)
      topics = topicText(topics_.color()) + topicText(topics_.depth()) + infoText();
    if (missing_pause_.isDue(now, topics)) {
      const std::string arrivals = pairing_->describeArrivals(
          {topicText(topics_.color()), topicText(topics_.depth()), infoText()});
      NODELET_WARN("no complete frame for %.0f s. %s", missing_after_s_, arrivals.c_str());
    }
    if (!sets_since_look_) {
      const ros::Time time = ros::Time::now();
      clock_defect_ = time.isZero() ? clockDefect(time, time, ros::Time::isSimTime()) : "";
    }
    // Not by NODELET_WARN_THROTTLE: it goes by ROS time.
    const std::string clock_case = clock_defect_.empty() ? "" : "defect";
    if (clock_pause_.isDue(now, clock_case)) NODELET_WARN("%s", clock_defect_.c_str());
    sets_since_look_ = false;
  }

  /// The topic and, where it has no publisher, which ones could be meant.
  std::string topicText(const ImageSubscriber& image) const {
    return image.hasPublisher() ? image.topic()
                                : unpublished(image.topic(), image.type(), image.advice());
  }
  std::string infoText() const {
    const ros::Subscriber& info = topics_.info();
    return info.getNumPublishers() > 0 ? info.getTopic()
                                       : unpublished(info.getTopic(), "sensor_msgs/CameraInfo", "");
  }
  std::string unpublished(const std::string& topic, const std::string& type,
                          const std::string& advice) const {
    return topic + " (it has no publisher" + advice +
           topicHint({topic, type}, getNodeHandle().getNamespace()) + ")";
  }

  pf::BlurConfig config_;
  InputSettings input_;
  bool is_rectified_ = false;
  double missing_after_s_ = 5.0;
  bool sets_since_look_ = false;
  std::string clock_defect_;  ///< of the last frame
  GrowingPause missing_pause_, clock_pause_;
  pf::Rectifier rectifier_;
  pf::ColorLearner color_;
  bool registers_color_ = false;
  std::optional<pf::PinholeCamera> depth_camera_;  ///< that the file of the colour camera is of
  std::string color_file_;
  std::unique_ptr<pf::BlurGate> gate_;
  std::unique_ptr<InputPairing> pairing_;
  ros::Publisher score_publisher_, info_publisher_, depth_publisher_, color_publisher_;
  CameraTopics topics_;
  ros::WallTimer timer_;
  std::unique_ptr<SettingsServer<GateSettings>> settings_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::BlurGateNodelet, nodelet::Nodelet)

// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <cstdio>
#include <memory>

#include "posefusion/slam/loop_thread.hpp"
#include "posefusion/slam/mapper.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/conversions.hpp"
#include "posefusion_ros/exact_matcher.hpp"
#include "posefusion_ros/map_output.hpp"
#include "posefusion_ros/map_query.hpp"
#include "posefusion_ros/map_saver.hpp"
#include "posefusion_ros/mapping_watch.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/pose_output.hpp"
#include "posefusion_ros/settings_server.hpp"
#include "posefusion_ros/stage_messages.hpp"
#include "posefusion_ros/trigger.hpp"
#include "posefusion_ros/worker.hpp"

namespace posefusion_ros {

using pf::FrameOutcome;
using pf::FrameStatus;
using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using std_srvs::Trigger;

/// Owns the map: tracks and fuses static frames, publishes pose and map, reports one status for
/// every frame of the chain. Everything that touches the map runs in the worker.
class FusionNodelet : public ChainNodelet {
 public:
  ~FusionNodelet() override {
    stopWaiting();
    for (ros::Subscriber* topic : {&rejected_, &info_, &color_, &depth_, &mask_, &flow_,
                                   &blur_score_, &in_map_mask_, &input_depth_}) {
      topic->shutdown();
    }
    settings_.reset();
    map_query_.reset();
    if (map_output_) worker_->post([this] { map_output_->close(); }).get();
    save_service_.shutdown();
    reset_service_.shutdown();
    worker_.reset();
    if (!saver_ || !saver_->isOn()) return;  // start() may have failed anywhere
    const std::string said = saver_->finish(mapper_->map(), trajectory());
    // The log is closed already when the whole manager ends.
    std::printf("%s: %s\n", getName().c_str(), said.c_str());
    std::fflush(stdout);
  }

 private:
  using Matcher =
      ExactMatcher<CameraInfo, Image, Image, Image, SparseFlowMsg, BlurScoreMsg, Image, Image>;

  void start() override {
    ros::NodeHandle& handle = getNodeHandle();
    Parameters parameters(getPrivateNodeHandle());
    const pf::Config config = parameters.config({"frame", "tracking", "map", "loop", "graph"});
    const bool lossless = parameters.flag("lossless", false);
    const PoseOutputSettings poses = readPoseOutput(parameters, lossless);
    map_frame_ = poses.map_frame;
    const int queue = parameters.integer("queue_size", 3, {1, 10000});
    mapper_ = std::make_unique<pf::Mapper>(config);
    loops_ = std::make_unique<pf::LoopThread>(
        config.loop, config.tracking,
        lossless ? pf::AnswerTime::after_lag : pf::AnswerTime::when_ready);
    saver_ = std::make_unique<MapSaver>(readMapSaver(parameters));
    report(parameters);

    pose_output_ = std::make_unique<PoseOutput>(handle, poses);
    matcher_ =
        std::make_unique<Matcher>(kInternalQueue, [this](const Matcher::Set& set) { onSet(set); });
    worker_ = std::make_unique<Worker<Matcher::Set>>(
        lossless ? 0 : queue, [this](const Matcher::Set& set) { process(set); });
    map_output_ = std::make_unique<MapOutput>(handle, poses.publishing, map_frame_,
                                              [this] { worker_->post([this] { showMap(); }); });
    offerSettings({config.tracking, poses.publishing});
    rejected_ = handle.subscribe(topics::kRejected, 1000, &FusionNodelet::onRejected, this);
    info_ =
        handle.subscribe(topics::kSharpCameraInfo, kInternalQueue, &FusionNodelet::onInfo, this);
    color_ = handle.subscribe(topics::kSharpColor, kInternalQueue, &FusionNodelet::onColor, this);
    depth_ = handle.subscribe(topics::kStaticDepth, kInternalQueue, &FusionNodelet::onDepth, this);
    mask_ = handle.subscribe(topics::kMask, kInternalQueue, &FusionNodelet::onMask, this);
    flow_ = handle.subscribe(topics::kFlow, kInternalQueue, &FusionNodelet::onFlow, this);
    blur_score_ =
        handle.subscribe(topics::kBlurScore, kInternalQueue, &FusionNodelet::onBlurScore, this);
    in_map_mask_ =
        handle.subscribe(topics::kInMapMask, kInternalQueue, &FusionNodelet::onInMapMask, this);
    input_depth_ =
        handle.subscribe(topics::kSharpDepth, kInternalQueue, &FusionNodelet::onInputDepth, this);
    // Services wait for the worker: in a queue of their own.
    ros::NodeHandle& services = getMTPrivateNodeHandle();
    save_service_ = services.advertiseService("save_map", &FusionNodelet::onSave, this);
    reset_service_ = services.advertiseService("reset", &FusionNodelet::onReset, this);
    whenReady([this] { return color_.getNumPublishers() > 0 && mask_.getNumPublishers() > 0; },
              [this] { advertiseStatus(); });
  }

  void offerSettings(const FusionSettings& initial) {
    ros::NodeHandle& services = getMTPrivateNodeHandle();
    const auto post = [this](std::function<void()> task) { return worker_->post(std::move(task)); };
    const auto apply = [this](const FusionSettings& settings) {
      mapper_->set(settings.tracking);
      pose_output_->set(settings.publishing);
      map_output_->set(settings.publishing);
    };
    settings_ = std::make_unique<SettingsServer<FusionSettings>>(
        services, initial,
        [post, apply](const FusionSettings& settings) { post([&] { apply(settings); }).get(); });
    map_query_ = std::make_unique<MapQuery>(services, post, [this](std::size_t max_points) {
      return map_output_->cloud(mapper_->map(), last_, pose_output_->mapFromStart(), max_points);
    });
  }

  /// To someone who has just begun to listen.
  void showMap() {
    map_output_->reset();
    map_output_->publishSurfels(mapper_->map(), last_, pose_output_->mapFromStart());
  }

  void advertiseStatus() {
    const std::lock_guard<std::mutex> lock(status_mutex_);
    status_publisher_ = getNodeHandle().advertise<TrackingStatusMsg>(topics::kStatus, 1000);
  }

  void onInfo(const sensor_msgs::CameraInfoConstPtr& info) { matcher_->add<0>(info); }
  void onColor(const sensor_msgs::ImageConstPtr& image) { matcher_->add<1>(image); }
  void onDepth(const sensor_msgs::ImageConstPtr& image) { matcher_->add<2>(image); }
  void onMask(const sensor_msgs::ImageConstPtr& image) { matcher_->add<3>(image); }

  void onFlow(const SparseFlowMsg::ConstPtr& flow) { matcher_->add<4>(flow); }
  void onBlurScore(const BlurScoreMsg::ConstPtr& score) {
    if (score->sharp) matcher_->add<5>(score);
  }
  void onInMapMask(const sensor_msgs::ImageConstPtr& image) { matcher_->add<6>(image); }
  void onInputDepth(const sensor_msgs::ImageConstPtr& image) { matcher_->add<7>(image); }

  void onSet(const Matcher::Set& set) {
    if (const auto dropped = worker_->push(set)) {
      reject(std::get<1>(*dropped)->header, TrackingStatusMsg::DROPPED,
             "dropped: fusion fell behind");
    }
  }

  /// A frame that another stage, or this one, has given up.
  void onRejected(const TrackingStatusMsg::ConstPtr& rejected) {
    worker_->post([this, rejected] {
      publishStatus(mapper_->skip(toNs(rejected->header.stamp), FrameOutcome::bad_input),
                    rejected->header.stamp, rejected->reason, rejected->outcome);
    });
  }

  /// In the worker.
  void process(const Matcher::Set& set) {
    const std_msgs::Header& header = std::get<1>(set)->header;
    guarded(header, [&] { fuse(set); });
    last_ = header.stamp;
    map_output_->publishView(mapper_->view(), last_, false);  // always: the segmenter may wait
  }

  void fuse(const Matcher::Set& set) {
    const auto& [info, color, depth, mask, flow, blur, in_map, input_depth] = set;
    if (color->header.stamp < last_) startAnew();
    pf::StaticFrame input;
    input.frame = toFrame(color, depth, toCamera(*info, false));
    const cv::Mat people = cv_bridge::toCvShare(mask)->image;
    if (cv::countNonZero(people) > 0) input.mask = people;
    const cv::Mat people_in_map = cv_bridge::toCvShare(in_map)->image;
    if (cv::countNonZero(people_in_map) > 0) {
      input.in_map_mask = people_in_map;
      input.input_depth = toDepth(input_depth);
    }
    input.flow = fromMessage(*flow);
    input.forced = blur->forced != 0;
    const FrameStatus status = mapper_->process(input);
    loops_->serve(*mapper_);
    if (status.map_full) NODELET_WARN_THROTTLE(30.0, "the map is full (~map/memory_limit_mb)");
    std::string reason = reasonOf(status);
    if (status.located) publishPose(color->header, status, reason);
    if (!reason.empty()) NODELET_WARN_THROTTLE(5.0, "%s", reason.c_str());
    mapping_watch_.note(status, *mapper_, loops_->counts(), watch());
    map_output_->publishSurfels(mapper_->map(), color->header.stamp, pose_output_->mapFromStart());
    publishStatus(status, color->header.stamp, reason, static_cast<std::uint8_t>(status.outcome));
  }

  /// Keeps and publishes the pose of a located frame; what goes wrong is added to `reason`.
  void publishPose(const std_msgs::Header& image, const FrameStatus& status, std::string& reason) {
    std::string note;
    if (!pose_output_->publish(image, status, note)) note = "no pose published: " + note;
    if (pose_output_->mapFromStart()) saver_->setFrame(*pose_output_->mapFromStart());
    const pf::StampedPose pose{status.stamp_ns, status.T_map_camera};
    const std::string unwritten = saver_->note(pose, mapper_->map());
    if (!unwritten.empty()) NODELET_WARN_THROTTLE(30.0, "%s", unwritten.c_str());
    if (!reason.empty() && !note.empty()) reason += "; ";
    reason += note;
  }

  void publishStatus(const FrameStatus& status, const ros::Time& stamp, const std::string& reason,
                     std::uint8_t outcome) {
    noteOutcome(stamp, outcome);
    std_msgs::Header header;
    header.stamp = stamp;
    header.frame_id = map_frame_;
    TrackingStatusMsg message = toMessage(
        status, header,
        pose_output_->mapFromStart().value_or(pf::bodyFromOptical()) * status.T_map_camera);
    message.outcome = outcome;
    message.reason = reason;
    const std::lock_guard<std::mutex> lock(status_mutex_);
    if (status_publisher_) status_publisher_.publish(message);
  }

  /// The bag is played again: what there was is kept in a folder of its own.
  void startAnew() {
    try {
      const std::string said = saver_->beginAnew(mapper_->map(), trajectory());
      if (!said.empty()) NODELET_INFO("%s", said.c_str());
    } catch (const std::exception& error) {  // the new map is worth more than the old one
      NODELET_ERROR("the map before the jump is lost: %s", error.what());
      saver_->abandon();
    }
    clear();
  }

  void clear() {
    mapper_->reset();
    loops_->reset();
    pose_output_->reset();
    map_output_->reset();
  }

  /// Of the located frames, as loops have corrected them.
  pf::Trajectory trajectory() const { return mapper_->backEnd().trajectory(); }

  std::string save() { return saver_->save(mapper_->map(), trajectory()); }

  bool onSave(Trigger::Request&, Trigger::Response& response) {
    return answer([this] { return save(); }, response);
  }

  bool onReset(Trigger::Request&, Trigger::Response& response) {
    const auto task = [this] {
      std::string said = saver_->beginAnew(mapper_->map(), trajectory());
      clear();
      map_output_->publishView(mapper_->view(), last_, true);
      return said + (said.empty() ? "" : "; ") +
             "the map is empty, the next frame begins a new one";
    };
    return answer(task, response);
  }

  bool answer(const std::function<std::string()>& task, Trigger::Response& response) {
    answerTrigger([this](const auto& work) { return worker_->post(work); }, task, response);
    if (response.success) {
      NODELET_INFO("%s", response.message.c_str());
    } else {
      NODELET_ERROR("%s", response.message.c_str());
    }
    return true;
  }

  std::string map_frame_;
  std::unique_ptr<MapSaver> saver_;
  std::unique_ptr<pf::Mapper> mapper_;
  std::unique_ptr<pf::LoopThread> loops_;
  MappingWatch mapping_watch_;
  ros::Time last_;  // the newest frame
  std::unique_ptr<MapOutput> map_output_;
  std::unique_ptr<PoseOutput> pose_output_;
  std::mutex status_mutex_;  // guards status_publisher_, which is advertised late
  ros::Publisher status_publisher_;
  std::unique_ptr<Matcher> matcher_;
  std::unique_ptr<Worker<Matcher::Set>> worker_;
  ros::Subscriber rejected_, info_, color_, depth_, mask_, flow_, blur_score_, in_map_mask_,
      input_depth_;
  ros::ServiceServer save_service_, reset_service_;
  std::unique_ptr<SettingsServer<FusionSettings>> settings_;
  std::unique_ptr<MapQuery> map_query_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::FusionNodelet, nodelet::Nodelet)

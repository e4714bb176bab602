// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <cstdio>
#include <memory>
#include <utility>

#include "fusion_input.hpp"
#include "fusion_services.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/closer_link.hpp"
#include "posefusion_ros/end_signals.hpp"
#include "posefusion_ros/map_output.hpp"
#include "posefusion_ros/mapping_session.hpp"
#include "posefusion_ros/mapping_watch.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/place_hint.hpp"
#include "posefusion_ros/pose_output.hpp"
#include "posefusion_ros/robot_input.hpp"
#include "posefusion_ros/status_output.hpp"
#include "posefusion_ros/surface_output.hpp"
#include "posefusion_ros/worker.hpp"
#include "transform_hold.hpp"

namespace posefusion_ros {

using pf::FrameOutcome;
using pf::FrameStatus;

/// Owns the map: tracks and fuses static frames, asks the loop closer, publishes pose and map,
/// reports one status for every frame of the chain. Everything that touches the map runs in the
/// worker.
class FusionNodelet : public ChainNodelet {
 public:
  ~FusionNodelet() override {
    stopWaiting();
    if (hold_) hold_->stop();
    if (closer_) closer_->hurry(true);
    rejected_.shutdown();
    input_.reset();
    if (services_) services_->shutdown();
    if (map_output_) worker_->post([this] { map_output_->close(); }).get();
    if (surfaces_) surfaces_->close();
    worker_.reset();
    status_.clearText();                      // it is sent while the map is saved
    if (!session_) return;                    // start() may have failed anywhere
    if (is_lossless_) closer_->hurry(false);  // what it still has to say counts
    const std::string said = session_->finish();
    if (!session_->saver().savesAtTheEnd()) return;
    // The log is closed already when the whole manager ends.
    std::printf("%s: %s\n", getName().c_str(), said.c_str());
    std::fflush(stdout);
  }

 private:
  using Set = FusionInput::Set;

  void start() override {
    ros::NodeHandle& handle = getNodeHandle();
    Parameters parameters(getPrivateNodeHandle());
    const MappingSettings settings = readMapping(parameters);
    const PoseOutputSettings poses = readPoseOutput(parameters, settings.lossless);
    const SurfaceOutputSettings surfaces = readSurfaceOutput(parameters);
    const RobotInputSettings robot = readRobotInput(parameters, poses.odom_frame);
    map_frame_ = poses.map_frame;
    is_lossless_ = settings.lossless;
    const int queue = parameters.integer("queue_size", 3, {1, 10000});
    const double patience_s = parameters.number("closer_timeout_s", 20.0, {0.01, 3600.0});
    auto closer = std::make_unique<CloserLink>(handle, patience_s);
    report(parameters);
    endWellOnSignals();
    CloserLink* const link = closer.get();
    session_ = std::make_unique<MappingSession>(settings, std::move(closer));
    closer_ = link;
    tell(session_->takeNotices());
    pose_output_ = std::make_unique<PoseOutput>(handle, poses);
    beginPoses();
    worker_ = std::make_unique<Worker<Set>>(settings.lossless ? 0 : queue,
                                            [this](const Set& set) { process(set); });
    map_output_ = std::make_unique<MapOutput>(handle, poses.publishing, map_frame_,
                                              [this] { worker_->post([this] { showMap(); }); });
    // In the worker, as subscribers that are already there call it from that thread.
    worker_
        ->post([&] {
          surfaces_ = std::make_unique<SurfaceOutput>(
              handle, surfaces, poses.publishing, map_frame_,
              [this] { worker_->post([this] { offerSurfaces(last_); }); });
        })
        .get();
    offerServices({settings.config.tracking, poses.publishing});
    if (!is_lossless_) {
      hold_ = std::make_unique<TransformHold>(getMTNodeHandle(), [this](const ros::Time& now) {
        worker_->post([this, now] { pose_output_->hold(now); });
      });
    }
    robot_ = std::make_unique<RobotInput>(handle, robot);
    hint_ = std::make_unique<PlaceHint>(handle);
    rejected_ = handle.subscribe(topics::kRejected, 1000, &FusionNodelet::onRejected, this);
    input_ = std::make_unique<FusionInput>(handle, [this](const Set& set) { onSet(set); });
    // A chain that is lossless waits for the closer too, so that the first answer is not missed.
    const bool needs_closer = settings.lossless && settings.config.loop.enabled;
    const auto end = ros::WallTime::now() + ros::WallDuration(patience_s);
    whenReady(
        [this, needs_closer, end] {
          return input_->isConnected() &&
                 (!needs_closer || closer_->isThere() || ros::WallTime::now() > end);
        },
        [this] { status_.advertise(getNodeHandle()); });
  }

  void offerServices(const FusionSettings& initial) {
    FusionServices::Actions actions;
    actions.post = [this](std::function<void()> task) { return worker_->post(std::move(task)); };
    actions.shows_another = [this] { showAnother(); };
    actions.draw = [this](std::size_t max_points) {
      return map_output_->cloud(session_->mapper().map(), last_, pose_output_->mapFromStart(),
                                max_points);
    };
    actions.apply = [this](const FusionSettings& settings) {
      session_->set(settings.tracking);
      pose_output_->set(settings.publishing);
      map_output_->set(settings.publishing);
      surfaces_->set(settings.publishing);
    };
    // Services wait for the worker: in a queue of their own.
    services_ = std::make_unique<FusionServices>(getMTPrivateNodeHandle(), *session_,
                                                 std::move(actions), initial);
  }

  /// For a new subscriber.
  void showMap() {
    map_output_->reset();
    publishMap(last_);
  }

  void publishMap(const ros::Time& stamp) {
    map_output_->publishSurfels(session_->mapper().map(), stamp, pose_output_->mapFromStart());
  }

  void offerSurfaces(const ros::Time& stamp) {
    surfaces_->offer(stamp, [this](const ros::Time& now) {
      return snapshotOf(*session_, pose_output_->mapFromStart(), now);
    });
  }

  void onSet(const Set& set) {
    if (const auto dropped = worker_->push(set)) {
      reject(FusionInput::headerOf(*dropped), TrackingStatusMsg::DROPPED,
             "dropped: fusion fell behind");
    }
  }

  /// A frame that another stage, or this one, has given up.
  void onRejected(const TrackingStatusMsg::ConstPtr& rejected) {
    worker_->post(
        [this, rejected] { skip(rejected->header.stamp, rejected->outcome, rejected->reason); });
  }

  /// In the worker.
  void process(const Set& set) {
    const std_msgs::Header& header = FusionInput::headerOf(set);
    guarded(header, [&] {
      if (header.stamp < last_) onTimeBack();
      if (services_->isPaused()) {
        skip(header.stamp, TrackingStatusMsg::PAUSED, "paused");
      } else {
        fuse(set);
      }
    });
    last_ = header.stamp;
    publishView(false);  // the segmenter may wait
  }

  void publishView(bool reset) {
    map_output_->publishView(session_->mapper().view(), last_, pose_output_->mapFromStart(), reset);
  }

  void fuse(const Set& set) {
    const std_msgs::Header& header = FusionInput::headerOf(set);
    const int version = session_->mapper().backEnd().graph().version();
    const std::string deaf = robot_->tell(header, *session_);
    if (!deaf.empty()) NODELET_WARN_THROTTLE(30.0, "%s", deaf.c_str());
    hint_->tell(header, *session_, *pose_output_);
    std::string trouble;
    const FrameStatus status = session_->process(toStaticFrame(set), header.frame_id, trouble);
    tell(session_->takeNotices());
    if (status.map_full) NODELET_WARN_THROTTLE(30.0, "the map is full (~map/memory_limit_mb)");
    if (!trouble.empty()) NODELET_WARN_THROTTLE(30.0, "%s", trouble.c_str());
    const std::string unanswered = closer_->takeComplaint();
    if (!unanswered.empty()) NODELET_WARN_THROTTLE(30.0, "%s", unanswered.c_str());
    std::string reason = reasonOf(status);
    if (status.located) publishPose(header, status, reason);
    if (status.provisional) pose_output_->publishProvisional(header, *status.provisional);
    if (!reason.empty()) NODELET_WARN_THROTTLE(5.0, "%s", reason.c_str());
    if (session_->mapper().backEnd().graph().version() != version) {
      pose_output_->correct(session_->mapper().backEnd().trajectory());
    }
    mapping_watch_.note(status, *session_, watch());
    publishMap(header.stamp);
    offerSurfaces(header.stamp);
    publishStatus(status, header.stamp, reason, static_cast<std::uint8_t>(status.outcome));
  }

  /// Publishes the pose of a located frame; what goes wrong is added to `reason`.
  void publishPose(const std_msgs::Header& image, const FrameStatus& status, std::string& reason) {
    std::string note;
    if (!pose_output_->publish(image, status, note)) note = "no pose published: " + note;
    if (pose_output_->mapFromStart()) session_->place(*pose_output_->mapFromStart());
    if (!reason.empty() && !note.empty()) reason += "; ";
    reason += note;
  }

  /// The status of a frame that is not mapped.
  void skip(const ros::Time& stamp, std::uint8_t outcome, const std::string& reason) {
    publishStatus(session_->mapper().skip(toNs(stamp), FrameOutcome::bad_input), stamp, reason,
                  outcome);
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
    message.unanswered = session_->loops().unanswered();
    status_.publish(message);
    if (hold_) hold_->heard(stamp);
    if (!status.located) pose_output_->hold(stamp);
  }

  /// A bag that is played again begins another map, a clock that was put back does not.
  void onTimeBack() {
    const bool is_replayed = ros::Time::isSimTime();
    std::string unsaved;
    const std::string said =
        is_replayed ? session_->startAnew(unsaved) : session_->restartClock(unsaved);
    if (!said.empty()) NODELET_INFO("%s", said.c_str());
    if (!unsaved.empty()) NODELET_ERROR("the map before the jump %s", unsaved.c_str());
    if (is_replayed) return beginOutput();
    NODELET_WARN("the clock was put back: the map goes on, the camera is looked for in it");
    pose_output_->restartClock();
    map_output_->reset();
    surfaces_->restartClock();
  }

  void beginPoses() {
    if (session_->isLoaded()) {
      pose_output_->load(session_->mapper().placed());
    } else {
      pose_output_->reset();
    }
  }

  void beginOutput() {
    beginPoses();
    map_output_->reset();
    surfaces_->reset();
  }

  /// Another map, on request.
  void showAnother() {
    beginOutput();
    publishView(true);
  }

  std::string map_frame_;
  bool is_lossless_ = false;
  CloserLink* closer_ = nullptr;  // of session_
  std::unique_ptr<MappingSession> session_;
  MappingWatch mapping_watch_;
  ros::Time last_;  // the newest frame
  std::unique_ptr<MapOutput> map_output_;
  std::unique_ptr<SurfaceOutput> surfaces_;
  std::unique_ptr<PoseOutput> pose_output_;
  StatusOutput status_;
  std::unique_ptr<TransformHold> hold_;
  std::unique_ptr<RobotInput> robot_;
  std::unique_ptr<PlaceHint> hint_;
  std::unique_ptr<Worker<Set>> worker_;
  std::unique_ptr<FusionInput> input_;
  ros::Subscriber rejected_;
  std::unique_ptr<FusionServices> services_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::FusionNodelet, nodelet::Nodelet)

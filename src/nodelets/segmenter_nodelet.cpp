// SPDX-License-Identifier: BSD-3-Clause
#include <visualization_msgs/MarkerArray.h>
#include <pluginlib/class_list_macros.hpp>

#include <boost/make_shared.hpp>
#include <memory>

#include "posefusion/run/people_picture.hpp"
#include "posefusion/segmentation/segmenter.hpp"
#include "posefusion_ros/background.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/exact_matcher.hpp"
#include "posefusion_ros/model_view.hpp"
#include "posefusion_ros/moving_object_messages.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/running_settings.hpp"
#include "posefusion_ros/settings_server.hpp"
#include "posefusion_ros/skeleton_markers.hpp"
#include "posefusion_ros/transforms.hpp"
#include "posefusion_ros/worker.hpp"

namespace posefusion_ros {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

constexpr std::chrono::milliseconds kViewPatience(5000);
constexpr double kLastMessage_s = 0.2;

/// Takes people out of the depth. Lossless, each frame is compared with the map as it was after the
/// frame before it; live, with the newest view of the map.
class SegmenterNodelet : public ChainNodelet {
 public:
  ~SegmenterNodelet() override {
    stopWaiting();
    background_.stop();
    for (ros::Subscriber* subscriber : {&view_, &info_, &depth_, &color_, &people_}) {
      subscriber->shutdown();
    }
    if (worker_) worker_->stop();
    // What is shown of the last frame would stay for good; it takes a moment to be sent.
    if (clearMarkers()) ros::WallDuration(kLastMessage_s).sleep();
  }

 private:
  using Matcher = ExactMatcher<CameraInfo, Image, Image, PeopleMsg>;

  void start() override {
    Parameters parameters(getPrivateNodeHandle());
    const pf::Config config = parameters.config({"segmentation", "sensor", "frame"});
    const SegmenterSettings settings = {config.segmentation};
    segmenter_ =
        std::make_unique<pf::PeopleSegmenter>(config.segmentation, pf::depthSensorOf(config));
    lossless_ = parameters.flag("lossless", false);
    up_frame_ = plainFrame(parameters.text("up_frame", ""));
    const int queue = parameters.integer("queue_size", 3, {1, 10000});
    const LookupSettings lookup = readLookup(parameters, lossless_);
    report(parameters);
    if (!up_frame_.empty()) lookup_ = std::make_unique<ListeningLookup>(lookup);

    matcher_ =
        std::make_unique<Matcher>(kInternalQueue, [this](const Matcher::Set& set) { onSet(set); });
    worker_ = std::make_unique<Worker<Matcher::Set>>(
        lossless_ ? 0 : queue, [this](const Matcher::Set& set) {
          guarded(std::get<2>(set)->header, [&] { segment(set); });
        });
    settings_ = std::make_unique<SettingsServer<SegmenterSettings>>(
        getMTPrivateNodeHandle(), settings, [this](const SegmenterSettings& changed) {
          worker_->post([&] { segmenter_->set(changed.segmentation); }).get();
        });
    ros::NodeHandle& handle = getNodeHandle();
    view_ = handle.subscribe(topics::kModelView, kInternalQueue, &SegmenterNodelet::onView, this);
    info_ =
        handle.subscribe(topics::kSharpCameraInfo, kInternalQueue, &SegmenterNodelet::onInfo, this);
    depth_ =
        handle.subscribe(topics::kSharpDepth, kInternalQueue, &SegmenterNodelet::onDepth, this);
    color_ =
        handle.subscribe(topics::kSharpColor, kInternalQueue, &SegmenterNodelet::onColor, this);
    people_ = handle.subscribe(topics::kPeople, kInternalQueue, &SegmenterNodelet::onPeople, this);
    whenReady([this] { return color_.getNumPublishers() > 0 && people_.getNumPublishers() > 0; },
              [this] { advertise(); });
  }

  void advertise() {
    ros::NodeHandle& handle = getNodeHandle();
    const std::lock_guard<std::mutex> lock(publisher_mutex_);
    used_publisher_ = handle.advertise<PeopleMsg>(topics::kPeopleUsed, kInternalQueue);
    moving_publisher_ = handle.advertise<MovingObjectsMsg>(topics::kMovingObjects, kInternalQueue);
    moving_marker_publisher_ =
        handle.advertise<visualization_msgs::MarkerArray>(topics::kMovingObjectMarkers, 2);
    marker_publisher_ = handle.advertise<visualization_msgs::MarkerArray>(topics::kSkeletons, 2);
    picture_publisher_ = handle.advertise<Image>(topics::kPeopleImage, 2);
    depth_publisher_ = handle.advertise<Image>(topics::kStaticDepth, kInternalQueue);
    flow_publisher_ = handle.advertise<SparseFlowMsg>(topics::kFlow, kInternalQueue);
    mask_publisher_ = handle.advertise<Image>(topics::kMask, kInternalQueue);
  }

  void onView(const ModelViewMsg::ConstPtr& view) {
    background_.set(view);
    if (view->reset != 0) clearMarkers();
  }

  /// Takes all skeletons and boxes away. False where no viewer listens.
  bool clearMarkers() {
    const std::lock_guard<std::mutex> lock(publisher_mutex_);
    const bool of_people = clear(marker_publisher_, shown_frame_);
    return clear(moving_marker_publisher_, map_frame_) || of_people;
  }

  static bool clear(const ros::Publisher& publisher, const std::string& frame) {
    if (!publisher || publisher.getNumSubscribers() == 0) return false;
    std_msgs::Header header;
    header.frame_id = frame;
    publisher.publish(noMarkers(header));
    return true;
  }

  void onInfo(const sensor_msgs::CameraInfoConstPtr& info) { matcher_->add<0>(info); }
  void onDepth(const sensor_msgs::ImageConstPtr& image) { matcher_->add<1>(image); }
  void onColor(const sensor_msgs::ImageConstPtr& image) { matcher_->add<2>(image); }
  void onPeople(const PeopleMsg::ConstPtr& people) { matcher_->add<3>(people); }

  void onSet(const Matcher::Set& set) {
    if (const auto dropped = worker_->push(set)) {
      reject(std::get<2>(*dropped)->header, TrackingStatusMsg::DROPPED,
             "dropped: the segmenter fell behind");
    }
  }

  void segment(const Matcher::Set& set) {
    const auto& [info, depth, color, people] = set;
    const std_msgs::Header& header = color->header;
    if (background_.takeResets() > 0 || header.stamp < last_) {
      segmenter_->reset();
      flow_.reset();
      last_ = ros::Time();
    }
    const ModelViewMsg::ConstPtr view = viewFor(header.stamp);
    if (background_.stopped()) return;
    const pf::ModelView model = view ? fromMessage(view) : pf::ModelView();
    const pf::RgbdFrame frame = toFrame(color, depth, toCamera(*info, false));
    const pf::SparseFlow& flow = flow_.advance(frame);
    const pf::Segmentation result =
        segmenter_->segment(frame, flow_.images(), fromMessage(*people),
                            model.empty() ? nullptr : &model, upOf(header));
    last_ = header.stamp;
    publish(frame, result, flow, depth, header);
    if (model.T_world_map && model.fragment == pf::kFirstFragment) {
      publishMoving(result.moving, header.stamp, view->map_frame);
    }
  }

  /// Nothing is said while the camera's place in the map frame is not known.
  void publishMoving(const std::vector<pf::MovingObject>& moving, const ros::Time& stamp,
                     const std::string& map_frame) {
    const std::lock_guard<std::mutex> lock(publisher_mutex_);
    if (!moving_publisher_) return;
    std_msgs::Header header;
    header.stamp = stamp;
    header.frame_id = map_frame_ = map_frame;
    moving_publisher_.publish(
        boost::make_shared<const MovingObjectsMsg>(toMessage(moving, header)));
    if (moving_marker_publisher_.getNumSubscribers() == 0) return;
    moving_marker_publisher_.publish(toMarkers(moving, header));
  }

  /// Lossless: the view after the frame before this one, however long it takes.
  ModelViewMsg::ConstPtr viewFor(const ros::Time& stamp) {
    if (!lossless_) return background_.newest();
    if (last_.isZero()) return nullptr;
    while (!background_.waitFor(last_, kViewPatience) && !background_.stopped()) {
      NODELET_WARN(
          "frame %u.%09u waits for the map's view of the frame before it (is fusion "
          "running?)",
          stamp.sec, stamp.nsec);
    }
    return background_.newest();
  }

  std::optional<Eigen::Vector3d> upOf(const std_msgs::Header& header) {
    if (!lookup_) return std::nullopt;
    std::string note;
    const auto T = (*lookup_)->find(plainFrame(header.frame_id), up_frame_, header.stamp, note);
    if (!T) {
      NODELET_WARN_THROTTLE(5.0, "gravity unknown, horizontal means in the image plane: %s",
                            note.c_str());
      return std::nullopt;
    }
    if (!note.empty()) NODELET_WARN_THROTTLE(30.0, "%s", note.c_str());
    return T->linear() * Eigen::Vector3d::UnitZ();
  }

  void publish(const pf::RgbdFrame& frame, const pf::Segmentation& result,
               const pf::SparseFlow& flow, const sensor_msgs::ImageConstPtr& depth,
               const std_msgs::Header& header) {
    const std::lock_guard<std::mutex> lock(publisher_mutex_);
    if (!mask_publisher_) {
      reject(header, TrackingStatusMsg::DROPPED, "dropped: the chain is still starting");
      return;
    }
    used_publisher_.publish(boost::make_shared<const PeopleMsg>(toMessage(result.people, header)));
    if (marker_publisher_.getNumSubscribers() > 0) {
      marker_publisher_.publish(toMarkers(result.people, frame, header));
      shown_frame_ = header.frame_id;
    }
    if (picture_publisher_.getNumSubscribers() > 0) {
      picture_publisher_.publish(
          toImage(pf::drawPeople(frame.color, result.people, result.mask), "rgb8", header));
    }
    flow_publisher_.publish(SparseFlowMsg::ConstPtr(toMessage(flow, header)));
    const bool unchanged = result.static_depth.data == frame.depth.data;
    depth_publisher_.publish(unchanged ? depth
                                       : sensor_msgs::ImageConstPtr(toImage(
                                             result.static_depth, depth->encoding, header)));
    const cv::Mat mask =
        result.mask.empty() ? cv::Mat(cv::Mat::zeros(frame.depth.size(), CV_8UC1)) : result.mask;
    mask_publisher_.publish(sensor_msgs::ImageConstPtr(toImage(mask, "mono8", header)));
    watch().set("people", std::to_string(result.people.people.size()));
    passed(header.stamp);
  }

  bool lossless_ = false;
  std::string up_frame_;
  std::unique_ptr<ListeningLookup> lookup_;
  std::unique_ptr<pf::PeopleSegmenter> segmenter_;
  pf::FlowTracker flow_;
  ros::Time last_;  // the frame before; zero at the start
  Background background_;
  std::mutex publisher_mutex_;           // guards the publishers, which are advertised late
  std::string shown_frame_, map_frame_;  // of the skeletons, of the boxes
  ros::Publisher used_publisher_, moving_publisher_, moving_marker_publisher_, marker_publisher_,
      picture_publisher_, depth_publisher_, flow_publisher_, mask_publisher_;
  std::unique_ptr<Matcher> matcher_;
  std::unique_ptr<Worker<Matcher::Set>> worker_;
  // Last, so that they end first: their callbacks use the rest.
  ros::Subscriber view_, info_, depth_, color_, people_;
  std::unique_ptr<SettingsServer<SegmenterSettings>> settings_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::SegmenterNodelet, nodelet::Nodelet)

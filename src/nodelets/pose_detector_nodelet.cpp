// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include <boost/make_shared.hpp>
#include <memory>

#include "posefusion/io/people_json.hpp"
#include "posefusion/pose/detector.hpp"
#include "posefusion_ros/bags/bag_source.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/chain_nodelet.hpp"
#include "posefusion_ros/exact_matcher.hpp"
#include "posefusion_ros/names.hpp"
#include "posefusion_ros/running_settings.hpp"
#include "posefusion_ros/settings_server.hpp"
#include "posefusion_ros/worker.hpp"

namespace posefusion_ros {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

/// Finds people in sharp frames. Networks are loaded and run in a worker. Live, the pose network is
/// spared the frames that came while it was busy, so that it always sees the newest one; lossless,
/// each frame is given to the detector, which shows the network every n-th.
class PoseDetectorNodelet : public ChainNodelet {
 public:
  ~PoseDetectorNodelet() override { stopWaiting(); }

 private:
  using Matcher = ExactMatcher<CameraInfo, Image, Image>;

  void start() override {
    Parameters parameters(getPrivateNodeHandle());
    config_ = parameters.config({"pose"}).pose;
    lossless_ = parameters.flag("lossless", false);
    people_file_ = parameters.text("people_file", "");
    go_on_ = parameters.flag("without_people_if_no_detector", false);
    const int queue = parameters.integer("queue_size", 3, {1, 10000});
    report(parameters);

    matcher_ =
        std::make_unique<Matcher>(kInternalQueue, [this](const Matcher::Set& set) { onSet(set); });
    worker_ = std::make_unique<Worker<Matcher::Set>>(
        lossless_ ? 0 : queue, [this](const Matcher::Set& set) {
          guarded(std::get<2>(set)->header, [&] { detect(set); });
        });
    loaded_ = worker_->post([this] { load(); });
    settings_ = std::make_unique<SettingsServer<DetectorSettings>>(
        getMTPrivateNodeHandle(), DetectorSettings{config_},
        [this](const DetectorSettings& settings) {
          worker_
              ->post([&] {
                if (detector_) detector_->set(settings.pose);
              })
              .get();
        });
    ros::NodeHandle& handle = getNodeHandle();
    info_ = handle.subscribe(topics::kSharpCameraInfo, kInternalQueue, &PoseDetectorNodelet::onInfo,
                             this);
    depth_ =
        handle.subscribe(topics::kSharpDepth, kInternalQueue, &PoseDetectorNodelet::onDepth, this);
    color_ =
        handle.subscribe(topics::kSharpColor, kInternalQueue, &PoseDetectorNodelet::onColor, this);
    whenReady(
        [this] {
          return color_.getNumPublishers() > 0 &&
                 loaded_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
        },
        [this] {
          const std::lock_guard<std::mutex> lock(publisher_mutex_);
          people_ = getNodeHandle().advertise<PeopleMsg>(topics::kPeople, kInternalQueue);
        });
  }

  /// In the worker, before the first frame.
  void load() {
    try {
      pf::RecordedPeople recorded;
      if (config_.detector == "recorded") recorded = recordedPeople();
      detector_ = pf::makePoseDetector(config_, std::move(recorded));
      watch().set("detector", pf::chosenDetector(config_));
      NODELET_INFO("pose detector ready (%s)", pf::chosenDetector(config_).c_str());
    } catch (const std::exception& error) {
      no_detector_ = error.what();
      watch().tell(diagnostic_msgs::DiagnosticStatus::ERROR, "no detector: " + no_detector_);
      NODELET_ERROR("%s. %s", error.what(),
                    go_on_ ? "The chain goes on without removing people."
                           : "No frame is used (~without_people_if_no_detector: true goes on).");
      if (go_on_) {
        config_.detector = "none";
        detector_ = pf::makePoseDetector(config_, {});
      }
    }
  }

  /// Of people.json, or of a bag or TUM folder.
  pf::RecordedPeople recordedPeople() const {
    const std::string json = ".json";
    const bool is_json =
        people_file_.size() > json.size() &&
        people_file_.compare(people_file_.size() - json.size(), json.size(), json) == 0;
    return is_json ? pf::loadPeople(people_file_) : openInput(people_file_)->people();
  }

  void onInfo(const sensor_msgs::CameraInfoConstPtr& info) { matcher_->add<0>(info); }
  void onDepth(const sensor_msgs::ImageConstPtr& image) { matcher_->add<1>(image); }
  void onColor(const sensor_msgs::ImageConstPtr& image) { matcher_->add<2>(image); }

  void onSet(const Matcher::Set& set) {
    if (const auto dropped = worker_->push(set)) {
      reject(std::get<2>(*dropped)->header, TrackingStatusMsg::DROPPED,
             "dropped: the pose detector fell behind");
    }
  }

  void detect(const Matcher::Set& set) {
    const auto& [info, depth, color] = set;
    if (!detector_) {
      reject(color->header, TrackingStatusMsg::NO_DETECTOR, no_detector_);
      return;
    }
    const pf::RgbdFrame frame = toFrame(color, depth, toCamera(*info, false));
    const bool haste = !lossless_ && worker_->waiting() > 0;
    const pf::People people = haste ? detector_->detectInHaste(frame) : detector_->detect(frame);
    const std::lock_guard<std::mutex> lock(publisher_mutex_);
    if (!people_) {
      reject(color->header, TrackingStatusMsg::DROPPED, "dropped: the chain is still starting");
      return;
    }
    if (people.detected) watch().set("people", std::to_string(people.people.size()));
    people_.publish(boost::make_shared<const PeopleMsg>(toMessage(people, color->header)));
    passed(color->header.stamp);
  }

  pf::PoseConfig config_;
  bool lossless_ = false;
  bool go_on_ = false;
  std::string people_file_;
  std::string no_detector_;  // why there is none
  std::unique_ptr<pf::PoseDetector> detector_;
  std::mutex publisher_mutex_;  // guards people_, which is advertised late
  ros::Publisher people_;
  std::unique_ptr<Matcher> matcher_;
  std::future<void> loaded_;
  std::unique_ptr<Worker<Matcher::Set>> worker_;
  // Last, so that they end first: their callbacks use the rest.
  ros::Subscriber info_, depth_, color_;
  std::unique_ptr<SettingsServer<DetectorSettings>> settings_;
};

}  // namespace posefusion_ros

PLUGINLIB_EXPORT_CLASS(posefusion_ros::PoseDetectorNodelet, nodelet::Nodelet)

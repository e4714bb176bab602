// SPDX-License-Identifier: BSD-3-Clause
#include "replay_report.hpp"

#include <filesystem>
#include <limits>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/io/map_file.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion_ros/bags/conversions.hpp"
#include "posefusion_ros/bags/stage_messages.hpp"
#include "posefusion_ros/names.hpp"

namespace posefusion_ros {
namespace {

constexpr int kStatusQueue = 100;
// Pictures of frames of which nothing is heard any more are not kept.
constexpr std::size_t kMostUnderWay = 100;

/// A frame that no stage looked at: its status is not of pf::FrameOutcome.
bool isLeftOut(const TrackingStatusMsg& status) {
  return status.outcome >= TrackingStatusMsg::DROPPED;
}

/// It reached the segmenter, so that a mask and people come.
bool isSegmented(const TrackingStatusMsg& status) {
  return !isLeftOut(status) && status.outcome != TrackingStatusMsg::BAD_INPUT &&
         status.outcome != TrackingStatusMsg::BLURRED;
}

pf::SurfelMap mapOf(const std::string& file) {
  pf::MapConfig config;
  config.stable_probability = 0;  // all that was saved is stable
  config.memory_limit_mb = 1e6;
  pf::SurfelMap map(config);
  map.add(pf::loadMap(file));
  return map;
}

}  // namespace

ReplayReport::ReplayReport(ros::NodeHandle& handle, const pf::Config& config, std::string output,
                           const pf::Trajectory& truth)
    : output_(std::move(output)), latest_before_(latest()), report_(config) {
  report_.setTruth(truth);
  mask_ = handle.subscribe(topics::kMask, kStatusQueue, &ReplayReport::onMask, this);
  people_ = handle.subscribe(topics::kPeopleUsed, kStatusQueue, &ReplayReport::onPeople, this);
}

std::string ReplayReport::latest() const {
  std::error_code ignored;
  return std::filesystem::canonical(output_ + "/latest", ignored).string();
}

void ReplayReport::sent(const pf::RgbdFrame& frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pf::ProcessedFrame& whole = under_way_[frame.stamp_ns].whole;
  whole.seen.frame = frame;
  // No message holds them.
  whole.seen.gate_ms = whole.seen.pose_ms = whole.seen.flow_ms = whole.segmentation_ms =
      std::numeric_limits<double>::quiet_NaN();
  if (under_way_.size() > kMostUnderWay) take(true);
}

ReplayReport::Frame* ReplayReport::find(const ros::Time& stamp) {
  const auto found = under_way_.find(toNs(stamp));
  return found == under_way_.end() ? nullptr : &found->second;
}

void ReplayReport::onMask(const sensor_msgs::ImageConstPtr& mask) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Frame* frame = find(mask->header.stamp);
  if (frame == nullptr) return;
  frame->whole.segmentation.mask = cv_bridge::toCvShare(mask)->image.clone();
  frame->has_mask = true;
  take(false);
}

void ReplayReport::onPeople(const PeopleMsg::ConstPtr& people) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Frame* frame = find(people->header.stamp);
  if (frame == nullptr) return;
  frame->whole.segmentation.people = fromMessage(*people);
  frame->has_people = true;
  take(false);
}

void ReplayReport::reported(const TrackingStatusMsg& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Frame* frame = find(status.header.stamp);
  if (frame == nullptr) return;
  frame->status = status;
  take(false);
}

/// Adds frames that are complete to the report, in order; `all`: those too that are not.
void ReplayReport::take(bool all) {
  while (!under_way_.empty()) {
    Frame& frame = under_way_.begin()->second;
    const bool is_known =
        frame.status && (!isSegmented(*frame.status) || (frame.has_mask && frame.has_people));
    if (!is_known && !all) return;
    if (!frame.status || isLeftOut(*frame.status)) {
      report_.addLeftOut(frame.status ? outcomeName(frame.status->outcome) : "without_status");
    } else {
      frame.whole.status = fromMessage(*frame.status);
      report_.add(frame.whole);
    }
    under_way_.erase(under_way_.begin());
    if (all && under_way_.size() <= kMostUnderWay / 2) all = false;
  }
}

std::string ReplayReport::write() {
  const std::lock_guard<std::mutex> lock(mutex_);
  while (!under_way_.empty()) take(true);
  const std::string folder = latest();
  if (folder.empty() || folder == latest_before_) {
    throw pf::InputError("no summary is written: fusion has saved nothing in " + output_);
  }
  report_.setCorrected(pf::loadTrajectory(folder + "/trajectory.txt"));
  const pf::SurfelMap map = mapOf(folder + "/map.ply");
  report_.writeSummary(folder, map.size());
  report_.writePictures(folder, map);
  return "\n" + report_.table() + "results  " + folder;
}

}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
#include "run_observers.hpp"

#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/people_json.hpp"

namespace pf {
namespace {

/// Before it the map is too young to be compared with.
constexpr int kFirstFrame = 50;

}  // namespace

MaskWriter::MaskWriter(const std::string& folder)
    : folder_(folder), objects_(folder + "/moving_objects.json") {
  makeFolder(folder + "/mask");
}

void MaskWriter::add(const ProcessedFrame& frame) {
  const RgbdFrame& input = frame.seen.frame;
  cv::Mat mask = frame.segmentation.mask;
  if (mask.empty()) mask = cv::Mat::zeros(input.camera.height, input.camera.width, CV_8UC1);
  savePng(folder_ + "/mask/" + formatStamp(input.stamp_ns) + ".png", mask);
  objects_.add(input.stamp_ns, frame.segmentation.moving);
  if (frame.seen.people.detected) people_.push_back(frame.seen.people);
}

void MaskWriter::finish() {
  savePeople(folder_ + "/people.json", people_);
  objects_.finish();
}

void StatusWriter::add(const ProcessedFrame& frame) {
  const FrameStatus& status = frame.status;
  StatusRow row;
  row.stamp_ns = status.stamp_ns;
  row.has_pose = status.located;
  row.state = name(status.state);
  row.outcome = name(status.outcome);
  row.reason = reasonOf(status);
  row.T_map_camera = status.T_map_camera;
  if (isGood(status.outcome)) row.covariance = status.covariance;
  row.is_provisional = status.provisional.has_value();
  if (status.provisional) {
    row.T_map_camera = status.provisional->T_map_camera;
    row.covariance = status.provisional->covariance;
  }
  rows_.push_back(std::move(row));
}

void LiveDepthCheck::add(const ProcessedFrame& frame) {
  if (index_++ < kFirstFrame || !isGood(frame.status.outcome)) return;
  RgbdFrame still = frame.seen.frame;
  still.depth = frame.segmentation.static_depth;
  check_.add(still, frame.segmentation.mask, frame.status.T_map_camera);
}

RunObservers::RunObservers(const RunOptions& options, const std::string& folder,
                           const SurfelMap& map) {
  if (options.save_masks) masks_.emplace(folder);
  if (!options.status_file.empty()) status_.emplace(options.status_file);
  if (options.check_depth) depth_.emplace(map);
}

void RunObservers::add(const ProcessedFrame& frame) {
  if (masks_) masks_->add(frame);
  if (status_) status_->add(frame);
  if (depth_) depth_->add(frame);
}

void RunObservers::finish(RunReport& report) {
  if (masks_) masks_->finish();
  if (status_) status_->finish();
  if (depth_) report.setDepthCheck(depth_->check());
}

}  // namespace pf

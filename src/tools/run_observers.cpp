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

MaskWriter::MaskWriter(const std::string& folder) : folder_(folder) {
  makeFolder(folder + "/mask");
}

void MaskWriter::add(const ProcessedFrame& frame) {
  const RgbdFrame& input = frame.seen.frame;
  cv::Mat mask = frame.segmentation.mask;
  if (mask.empty()) mask = cv::Mat::zeros(input.camera.height, input.camera.width, CV_8UC1);
  savePng(folder_ + "/mask/" + formatStamp(input.stamp_ns) + ".png", mask);
  if (frame.seen.people.detected) people_.push_back(frame.seen.people);
}

void MaskWriter::finish() const { savePeople(folder_ + "/people.json", people_); }

void LiveDepthCheck::add(const ProcessedFrame& frame) {
  if (index_++ < kFirstFrame || frame.status.outcome != FrameOutcome::fused) return;
  RgbdFrame still = frame.seen.frame;
  still.depth = frame.segmentation.static_depth;
  check_.add(still, frame.segmentation.mask, frame.status.T_map_camera);
}

}  // namespace pf

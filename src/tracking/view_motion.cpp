// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/view_motion.hpp"

#include <opencv2/imgproc.hpp>

#include "posefusion/frame/flow.hpp"

namespace pf {
namespace {

bool isSet(const cv::Mat& mask, const cv::Point2f& pixel) {
  const cv::Point at(cvRound(pixel.x), cvRound(pixel.y));
  return cv::Rect({0, 0}, mask.size()).contains(at) && mask.at<std::uint8_t>(at) != 0;
}

}  // namespace

SparseMotion motionFromView(const WorkingFrame& frame, const ModelView& view) {
  cv::Mat drawn, seen;
  view.intensity.convertTo(drawn, CV_8U);
  cv::cvtColor(frame.color, seen, cv::COLOR_RGB2GRAY);
  FlowTracker tracker;
  tracker.advance(drawn, 0);
  const SparseFlow& all = tracker.advance(seen, 1);
  const cv::Mat mapped = view.depth_m > 0;
  SparseFlow flow;
  for (std::size_t i = 0; i < all.before.size(); ++i) {
    if (!isSet(mapped, all.before[i]) || !isSet(frame.levels[0].still, all.after[i])) continue;
    flow.before.push_back(all.before[i]);
    flow.after.push_back(all.after[i]);
    flow.ids.push_back(all.ids[i]);
  }
  FlowScene scene{view.depth_m, frame.depth_m, nullptr};
  scene.sensor = frame.sensor;
  return estimateMotion(flow, scene, frame.camera);
}

}  // namespace pf

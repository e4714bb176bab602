// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/view_motion.hpp"

#include <opencv2/imgproc.hpp>

#include "posefusion/frame/flow.hpp"

namespace pf {
SparseMotion motionFromView(const WorkingFrame& frame, const ModelView& view) {
  cv::Mat drawn, seen;
  view.intensity.convertTo(drawn, CV_8U);
  cv::cvtColor(frame.color, seen, cv::COLOR_RGB2GRAY);
  FlowTracker tracker;
  tracker.advance(drawn, 0);
  const cv::Mat mapped = view.depth_m > 0;
  const SparseFlow flow =
      tracker.advance(seen, 1).only([&](const cv::Point2f& before, const cv::Point2f& after) {
        return isSet(mapped, before) && isSet(frame.levels[0].still, after);
      });
  FlowScene scene{view.depth_m, frame.depth_m, nullptr};
  scene.sensor = frame.sensor;
  return estimateMotion(flow, scene, frame.camera);
}

}  // namespace pf

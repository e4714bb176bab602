// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/expected_motion.hpp"

#include <utility>

#include "posefusion/tracking/sparse_motion.hpp"

namespace pf {

/// The step to the frame from the one before, by corners.
void ExpectedMotion::follow(const ModelView& view, const RgbdFrame& frame, const SparseFlow& flow,
                            const cv::Mat& depth_m) {
  const bool is_next = flow.to_ns == frame.stamp_ns && flow.from_ns == before_ns_;
  if (!is_next || before_m_.size() != depth_m.size()) return;
  const Eigen::Isometry3d T_view_before = constant_velocity_.predict(view, flow.from_ns);
  FlowScene scene{before_m_, depth_m, flow.from_ns == view.stamp_ns ? &view : nullptr};
  scene.before_still = before_still_;
  scene.sensor = sensor_;
  scene.expected = T_view_before.inverse() * constant_velocity_.predict(view, flow.to_ns);
  const SparseMotion step = estimateMotion(flow, scene, frame.camera);
  if (step.isSure()) steps_.push_back({flow.from_ns, flow.to_ns, step.T_before_after});
}

Eigen::Isometry3d ExpectedMotion::expect(const ModelView& view, const RgbdFrame& frame,
                                         const SparseFlow& flow, const cv::Mat& depth_m) {
  follow(view, frame, flow, depth_m);
  while (!steps_.empty() && steps_.front().from_ns < view.stamp_ns) steps_.pop_front();
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  std::int64_t reached_ns = view.stamp_ns;
  for (const Step& step : steps_) {
    if (step.from_ns != reached_ns) break;
    T_view_camera = T_view_camera * step.T_before_after;
    reached_ns = step.to_ns;
  }
  const Eigen::Isometry3d by_velocity = constant_velocity_.predict(view, frame.stamp_ns);
  return reached_ns == frame.stamp_ns ? T_view_camera : by_velocity;
}

void ExpectedMotion::keep(std::int64_t stamp_ns, const cv::Mat& mask, cv::Mat& depth_m) {
  std::swap(before_m_, depth_m);
  before_still_ = cv::Mat();
  before_ns_ = stamp_ns;
  if (mask.empty()) return;
  before_m_.setTo(0, mask);
  cv::compare(mask, 0, before_still_, cv::CMP_EQ);
}

}  // namespace pf

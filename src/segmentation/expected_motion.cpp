// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/expected_motion.hpp"

#include <algorithm>
#include <utility>

#include "posefusion/tracking/sparse_motion.hpp"

namespace pf {
namespace {

constexpr double kMaxSteps = 4.0;  // of the last motion that the next one is predicted from

/// The corners that lay on nothing that moves, by a mask of the frame before.
SparseFlow withoutMasked(const SparseFlow& flow, const cv::Mat& mask) {
  return flow.only(
      [&](const cv::Point2f& before, const cv::Point2f&) { return !isSet(mask, before); });
}

}  // namespace

Eigen::Isometry3d MotionPredictor::predict(const ModelView& view, std::int64_t stamp_ns) {
  if (frames_ == 0 || view.stamp_ns != newest_.stamp_ns) {
    before_ = newest_;
    newest_ = {view.stamp_ns, {view.fragment, view.T_uncorrected_camera()}};
    ++frames_;
  }
  Eigen::Isometry3d T_view_camera = Eigen::Isometry3d::Identity();
  const double last_step = static_cast<double>(newest_.stamp_ns - before_.stamp_ns);
  const double next_step = static_cast<double>(stamp_ns - newest_.stamp_ns);
  if (frames_ < 2 || last_step <= 0.0 || next_step <= 0.0) return T_view_camera;
  if (before_.pose.fragment != newest_.pose.fragment) return T_view_camera;
  const Eigen::Isometry3d T_before_view =
      before_.pose.T_map_camera.inverse() * newest_.pose.T_map_camera;
  const double steps = std::min(next_step / last_step, kMaxSteps);
  const Eigen::AngleAxisd turn(T_before_view.linear());
  T_view_camera.linear() = Eigen::AngleAxisd(turn.angle() * steps, turn.axis()).matrix();
  T_view_camera.translation() = steps * T_before_view.translation();
  return T_view_camera;
}

/// The step to the frame from the one before, by corners.
void ExpectedMotion::follow(const ModelView& view, const RgbdFrame& frame, const SparseFlow& flow,
                            const cv::Mat& depth_m) {
  const bool is_next = flow.to_ns == frame.stamp_ns && flow.from_ns == before_ns_;
  if (!is_next || before_m_.size() != depth_m.size()) return;
  const Eigen::Isometry3d T_view_before = constant_velocity_.predict(view, flow.from_ns);
  FlowScene scene{before_m_, depth_m, flow.from_ns == view.stamp_ns ? &view : nullptr};
  if (!before_mask_.empty()) scene.before_still = before_mask_ == 0;
  scene.sensor = sensor_;
  // A place to look first, and no more: of a jerk corners tell all.
  scene.expected =
      ExpectedStep{T_view_before.inverse() * constant_velocity_.predict(view, flow.to_ns)};
  const SparseMotion step = estimateMotion(withoutMasked(flow, before_mask_), scene, frame.camera);
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
  before_mask_ = mask;
  before_ns_ = stamp_ns;
}

}  // namespace pf

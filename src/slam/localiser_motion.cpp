// SPDX-License-Identifier: BSD-3-Clause
// What is known of a frame's motion before it is aligned.
#include <algorithm>

#include "posefusion/core/stamps.hpp"
#include "posefusion/core/symmetric.hpp"
#include "posefusion/slam/localiser.hpp"

namespace pf {
namespace {

// Added to what a robot may do, where nothing measures the motion.
constexpr double kFreeShift_m = 0.02, kFreeAngle_rad = 0.02;
constexpr double kMaxExtrapolation_s = 0.2;

/// The covariance of what a robot may do where nothing measures it.
Matrix6d ofFreeMotion(double elapsed_s) {
  return independentCovariance(kFreeShift_m + kRobotSpeed_m_s * elapsed_s,
                               kFreeAngle_rad + kRobotTurn_rad_s * elapsed_s);
}

/// Where the two contradict each other the pictures are believed: the map is made of them.
std::optional<MotionPrior> stepOf(const SparseMotion& motion,
                                  const std::optional<MotionPrior>& told) {
  if (!motion.found) return told;
  const MotionPrior seen{motion.T_before_after, motion.covariance, true};
  return told ? combined(seen, *told).value_or(seen) : seen;
}

}  // namespace

PosePrior Localiser::expect(const WorkingFrame& frame, std::int64_t stamp_ns,
                            const SparseFlow& flow, const ModelView* view,
                            const std::optional<MotionPrior>& told, Location& location) {
  const double elapsed_s = secondsBetween(previous_.stamp_ns, stamp_ns);
  location.motion = measure(frame, stamp_ns, flow, view);
  location.has_odometry = told && told->has_shift;
  location.step = stepOf(location.motion, told);
  const PosePrior prior = predict(location, elapsed_s);
  T_reckoned_ =
      orthonormalised(T_reckoned_ * previous_.T_map_camera.inverse() * prior.T_map_camera);
  recent_.add(previous_.T_map_camera.inverse() * prior.T_map_camera, elapsed_s);
  carry(location.step.value_or(MotionPrior()), location.has_odometry || location.motion.isSure());
  location.carried = carried_;
  return prior;
}

/// The map where the frame that `flow` begins with is believed to be; null: that is not known.
const ModelView* Localiser::viewBefore(const SparseFlow& flow, const ModelView& last,
                                       const ViewRenderer& render) const {
  if (flow.from_ns != previous_.stamp_ns) return nullptr;
  if (trusted_ns_ == previous_.stamp_ns) return &last;
  const bool is_known = state_ != TrackingState::lost || belief_ > 0;
  return is_known ? &render(previous_.T_map_camera) : nullptr;
}

/// By the corners that lead from the frame before.
SparseMotion Localiser::measure(const WorkingFrame& frame, std::int64_t stamp_ns,
                                const SparseFlow& flow, const ModelView* view) const {
  if (flow.to_ns != stamp_ns) return {};
  const bool follows = flow.from_ns == previous_.stamp_ns;  // else frames were left out between
  FlowScene scene{follows ? previous_.depth_m : cv::Mat(),
                  frame.full_depth_m,
                  view,
                  &landmarks_,
                  previous_.T_map_camera,
                  previous_.small.still,
                  frame.sensor};
  if (previous_.velocity_ns != 0) {
    const double step_s = secondsBetween(previous_.stamp_ns, stamp_ns);
    scene.expected = steadyStep(atConstantVelocity(step_s), step_s,
                                secondsBetween(previous_.velocity_ns, stamp_ns));
    scene.expected->covariance += step_s * step_s * previous_.velocity_covariance;
  }
  return estimateMotion(flow, scene, frame.full_camera);
}

Eigen::Isometry3d Localiser::atConstantVelocity(double elapsed_s) const {
  return expSe3(previous_.velocity * std::min(elapsed_s, kMaxExtrapolation_s));
}

PosePrior Localiser::predict(const Location& location, double elapsed_s) const {
  const std::optional<MotionPrior>& step = location.step;
  MotionPrior expected;
  if (step && step->has_shift) {
    expected = *step;
  } else {
    expected.T_before_after = atConstantVelocity(elapsed_s);
    expected.covariance = ofFreeMotion(elapsed_s);
    if (step) expected = combined(expected, *step).value_or(expected);
  }
  PosePrior prior;
  prior.is_measured = expected.has_shift;
  prior.T_map_camera = previous_.T_map_camera * expected.T_before_after;
  const Matrix6d A = adjoint(expected.T_before_after.inverse());
  // Against a step that is known apart from them, images of a bare wall, which say a little that
  // nothing moves, would gain weight with every frame.
  const Matrix6d& before =
      location.has_odometry ? previous_.covariance_to_view : previous_.covariance;
  prior.covariance = propagated(A, before) + expected.covariance;
  return prior;
}

PosePrior Localiser::startAt(const Eigen::Isometry3d& T_map_camera) {
  return {T_map_camera, ofFreeMotion(kMaxExtrapolation_s), false};
}

void Localiser::carry(const MotionPrior& step, bool is_known) {
  const Matrix6d A = adjoint(step.T_before_after.inverse());
  carried_.T_map_camera = orthonormalised(carried_.T_map_camera * step.T_before_after);
  carried_.covariance = propagated(A, carried_.covariance) + step.covariance;
  carried_.is_measured = carried_.is_measured && is_known;
}

}  // namespace pf

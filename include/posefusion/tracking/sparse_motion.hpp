// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/frame/model_view.hpp"
#include "posefusion/tracking/landmarks.hpp"

namespace pf {

/// The camera's motion between two frames, from corners.
struct SparseMotion {
  bool found = false;
  Eigen::Isometry3d T_before_after = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (m, rad) in the later camera's frame
  int matches = 0;                         ///< corners that were followed
  int inliers = 0;
  double rmse_px = 0;  ///< reprojection, over the inliers

  /// Agreed on by so many corners that they are hardly all on one thing that moves.
  bool isSure() const;
};

/// The motion between two frames as it is expected before they are compared; by its default
/// covariance, only where it is looked for first.
struct ExpectedStep {
  Eigen::Isometry3d T_before_after = Eigen::Isometry3d::Identity();
  Matrix6d covariance =
      Matrix6d::Identity();  ///< of the twist (m, rad) in the later camera's frame
};

/// The step of a camera that goes on as it moved `since_s` before its end: the longer ago, the more
/// may its speed have changed since.
ExpectedStep steadyStep(const Eigen::Isometry3d& T_before_after, double step_s, double since_s);

/// What is known of the corners' surroundings.
struct FlowScene {
  const cv::Mat& before_m;  ///< depth of the earlier frame, full size, CV_32FC1 in metres, 0 =
                            ///< invalid; empty where that frame is not at hand
  const cv::Mat& after_m;   ///< of the later frame; people removed in both
  const ModelView* view;    ///< the map from the earlier frame's pose; null where there is none
  const Landmarks* landmarks = nullptr;  ///< corners whose place in the map is known; may be null
  Eigen::Isometry3d T_map_before = Eigen::Isometry3d::Identity();  ///< pose of the earlier frame
  /// The earlier frame, any size: CV_8UC1, 0 = a person's pixel. Empty: no person is in view.
  cv::Mat before_still{};
  DepthSensor sensor{};
  std::optional<ExpectedStep> expected{};  ///< none: nothing is expected
};

/// Motion from the corners of `flow` that lie on the still world (not well before a stable surface
/// of the map: unmasked people; nor, without depth of their own, next to people or to something
/// near: a person too close for the sensor is not beyond its range): P3P with RANSAC (Fischler and
/// Bolles 1981; fixed seed) where few agree with what is expected, then least squares over
/// reprojection and inverse depth with Cauchy's weights and over what is expected, which is left
/// out of the covariance. Known landmarks stand where the map has them, so that the motion does not
/// drift from frame to frame; where they do not agree, it is measured from the earlier frame alone.
/// The camera is that of the full image, without distortion. Not found with fewer than a dozen
/// corners or when too few of them agree.
SparseMotion estimateMotion(const SparseFlow& flow, const FlowScene& scene,
                            const PinholeCamera& camera);

}  // namespace pf

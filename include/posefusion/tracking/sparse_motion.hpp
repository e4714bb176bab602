// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/frame/flow.hpp"

namespace pf {

/// The camera's motion between two frames, from corners.
struct SparseMotion {
  bool found = false;
  Eigen::Isometry3d T_before_after = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of the twist (m, rad) in the later camera's frame
  int matches = 0;                         ///< corners that were followed
  int inliers = 0;
  double rmse_px = 0;  ///< reprojection, over the inliers
};

/// Depth of a frame at full size, CV_32FC1 in metres, 0 = invalid; people removed.
struct FlowDepth {
  const cv::Mat& before_m;
  const cv::Mat& after_m;
};

/// Motion from the corners of `flow` that lie on the still world: P3P with RANSAC (Fischler and
/// Bolles 1981; fixed seed), then least squares over reprojection and inverse depth with Cauchy's
/// weights. The camera is that of the full image, without distortion. Not found with fewer than a
/// dozen corners or when less than half of them agree.
SparseMotion estimateMotion(const SparseFlow& flow, const FlowDepth& depth,
                            const PinholeCamera& camera);

}  // namespace pf

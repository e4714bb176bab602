// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/frame.hpp"
#include "posefusion/evaluation/surface_check.hpp"

namespace pf {

/// Which of the true surface was seen well: by three views that measured its depth (within 5 cm and
/// three standard deviations), beside people, within the range of the sensor and at less than 70
/// degrees from its normal. Whatever a map or a mesh has made of it.
class SeenSurface {
 public:
  static constexpr int kViews = 3;

  /// The samples must outlive it.
  SeenSurface(const SurfaceSamples& truth, const DepthSensor& sensor);

  /// An undistorted frame, its mask of people (CV_8UC1, 0 = no person; may be empty) and its true
  /// pose in the frame of the samples.
  void add(const RgbdFrame& frame, const cv::Mat& mask, const Eigen::Isometry3d& T_truth_camera);

  std::size_t views() const { return views_; }

  /// The samples that were seen well.
  SurfaceSamples seenWell() const;

 private:
  const SurfaceSamples& truth_;
  DepthSensor sensor_;
  std::vector<std::uint16_t> seen_;  ///< by how many views
  std::size_t views_ = 0;
  cv::Mat depth_m_;
};

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <opencv2/core.hpp>

#include "posefusion/core/depth_sensor.hpp"
#include "posefusion/core/frame.hpp"
#include "posefusion/core/map_pose.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/frame/model_view.hpp"

namespace pf {

/// Predicts where the camera is by constant velocity, from the stamps and poses of the last two
/// views that differ: a view may be older than the frame before (live, or where that was not
/// fused). Two views of different fragments give no motion.
class MotionPredictor {
 public:
  /// T_view_camera for the frame at `stamp_ns` given the newest view.
  Eigen::Isometry3d predict(const ModelView& view, std::int64_t stamp_ns);
  void reset() { *this = MotionPredictor(); }

 private:
  struct StampedPose {
    std::int64_t stamp_ns = 0;
    MapPose pose;
  };

  int frames_ = 0;  // views seen
  StampedPose newest_, before_;
};

/// The motion of the camera from the newest view of the map to a frame that is not aligned yet: by
/// the corners followed from frame to frame since that view (see estimateMotion()), and by constant
/// velocity where they do not lead so far. Not thread safe.
class ExpectedMotion {
 public:
  /// Of depth as `sensor` measures it.
  explicit ExpectedMotion(const DepthSensor& sensor) : sensor_(sensor) {}

  /// T_view_camera. `flow` leads to the frame from the one before; `depth_m`: of the frame,
  /// CV_32FC1, full size, 0 = none.
  Eigen::Isometry3d expect(const ModelView& view, const RgbdFrame& frame, const SparseFlow& flow,
                           const cv::Mat& depth_m);

  /// The frame's depth, for corners of the next one. `mask`: CV_8UC1, full size, not 0 where
  /// something moves, whose corners do not count; may be empty, is shared. Takes `depth_m` in
  /// exchange for one that is no longer needed.
  void keep(std::int64_t stamp_ns, const cv::Mat& mask, cv::Mat& depth_m);

 private:
  struct Step {
    std::int64_t from_ns, to_ns;
    Eigen::Isometry3d T_before_after;
  };

  void follow(const ModelView& view, const RgbdFrame& frame, const SparseFlow& flow,
              const cv::Mat& depth_m);

  DepthSensor sensor_;
  MotionPredictor constant_velocity_;
  std::deque<Step> steps_;  // since the view
  cv::Mat before_m_;        // depth of the frame before
  cv::Mat before_mask_;     // its pixels: not 0 where something moves; may be empty
  std::int64_t before_ns_ = 0;
};

}  // namespace pf

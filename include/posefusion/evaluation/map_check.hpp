// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/frame.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {

/// How well the depth of frames agrees with the map rendered from their poses: the absolute
/// difference along the optical axis at the pixels where both have depth, over all pixels of all
/// frames.
class DepthCheck {
 public:
  /// The map must outlive the check. Its active surfels do not matter: all are rendered.
  explicit DepthCheck(const SurfelMap& map);

  /// An undistorted frame. Pixels of `mask` (CV_8UC1, may be empty) that are not 0 are left out.
  void add(const RgbdFrame& frame, const cv::Mat& mask, const Eigen::Isometry3d& T_map_camera);

  std::size_t frames() const { return frames_; }
  std::size_t pixels() const { return pixels_; }
  /// Part of the pixels with depth where the map has depth too.
  double coverage() const;
  /// To a tenth of a millimetre; 0 when there are no pixels.
  double medianM() const;

 private:
  const SurfelMap& map_;
  SurfelRenderer renderer_;
  ModelView view_;
  cv::Mat depth_m_;
  std::vector<std::size_t> histogram_;
  std::size_t frames_ = 0, pixels_ = 0, measured_ = 0;
};

/// Which surfels lie on people. A surfel agrees with a frame when the depth measured at its pixel
/// is within `tolerance_m` of its own. It lies on a person when it agrees more often at pixels of
/// the true mask than beside it.
class PeopleCheck {
 public:
  explicit PeopleCheck(const SurfelArrays& surfels, double tolerance_m = 0.03);

  /// An undistorted frame, its true mask (CV_8UC1, 0 = no person) and its true pose in the map.
  void add(const RgbdFrame& frame, const cv::Mat& mask, const Eigen::Isometry3d& T_map_camera);

  std::size_t surfels() const { return on_mask_.size(); }
  std::size_t onPeople() const;
  /// onPeople() / surfels(), 0 of none.
  double part() const;
  bool isOnPerson(std::size_t surfel) const { return on_mask_[surfel] > beside_[surfel]; }

 private:
  const SurfelArrays& surfels_;
  double tolerance_m_;
  cv::Mat depth_m_;
  std::vector<std::uint32_t> on_mask_, beside_;  ///< frames that the surfel agreed with
};

/// Frames of which people leave enough, and how many of them have a pose.
class ViewCheck {
 public:
  static constexpr double kEnough = 0.25;  ///< part of the pixels, with depth and beside people

  /// An undistorted frame and its true mask (CV_8UC1, 0 = no person).
  void add(const RgbdFrame& frame, const cv::Mat& mask, bool has_pose);

  std::size_t frames() const { return frames_; }
  std::size_t posed() const { return posed_; }

 private:
  cv::Mat depth_m_;
  std::size_t frames_ = 0, posed_ = 0;
};

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/run/plan_picture.hpp"

namespace pf {

/// From the frame of the truth to the pixels of a plan: seen along gravity, the long side across.
class PlanView {
 public:
  static constexpr int kWidth = 1200, kTallest = 1000, kMargin = 30;

  explicit PlanView(const Plan& plan);

  double scale() const { return scale_; }  ///< pixels for a metre
  int height() const { return 2 * kMargin + static_cast<int>(scale_ * v_.size()); }
  cv::Point2d at(const Eigen::Vector3d& point) const;

  /// The surface into a picture of this view (CV_8UC3 R G B).
  void drawSurface(const Plan& plan, cv::Mat& picture) const;

 private:
  struct Range {
    double low = 0, high = 0;
    double size() const { return high - low; }
    /// Takes in the values but for a share of `cut` at each end.
    void extend(std::vector<double> values, double cut);
  };
  struct Splat;

  void measure(const Plan& plan);
  std::vector<Splat> splatsOf(const Plan& plan) const;

  Eigen::Vector3d up_, right_, ahead_;
  Range u_, v_;
  double scale_ = 1, shift_ = 0;
};

}  // namespace pf

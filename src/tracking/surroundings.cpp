// SPDX-License-Identifier: BSD-3-Clause
#include "surroundings.hpp"

#include <opencv2/imgproc.hpp>

namespace pf {
namespace {

constexpr int kCell_px = 8;
constexpr float kPerson_m = -1.0F;

}  // namespace

Surroundings::Surroundings(const cv::Mat& depth_m, const cv::Mat& still) : full_(depth_m.size()) {
  const cv::Size cells(full_.width / kCell_px, full_.height / kCell_px);
  if (cells.empty()) return;
  cv::Mat depth, mask, distance;
  cv::resize(depth_m, depth, cells, 0, 0, cv::INTER_NEAREST);
  if (!still.empty()) {
    cv::resize(still, mask, cells, 0, 0, cv::INTER_NEAREST);
    depth.setTo(kPerson_m, mask == 0);
  }
  const cv::Mat unknown = depth == 0;
  cv::distanceTransform(unknown, distance, nearest_, cv::DIST_L2, 3, cv::DIST_LABEL_PIXEL);
  depth_of_.assign(static_cast<std::size_t>(cells.area()) + 1, 0.0F);
  for (int v = 0; v < cells.height; ++v) {
    for (int u = 0; u < cells.width; ++u) {
      const float shown = depth.at<float>(v, u);
      if (shown > 0) depth_of_[static_cast<std::size_t>(nearest_.at<int>(v, u))] = shown;
    }
  }
}

double Surroundings::depthBeside(const cv::Point2f& pixel) const {
  if (depth_of_.empty()) return 0;
  const int v = static_cast<int>(pixel.y) * nearest_.rows / full_.height;
  const int u = static_cast<int>(pixel.x) * nearest_.cols / full_.width;
  const bool inside = u >= 0 && v >= 0 && u < nearest_.cols && v < nearest_.rows;
  return inside ? depth_of_[static_cast<std::size_t>(nearest_.at<int>(v, u))] : 0;
}

}  // namespace pf

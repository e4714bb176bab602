// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/map_check.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr double kLeastDepth_m = 0.1;
constexpr double kMostDepth_m = 20.0;
constexpr double kBin_m = 1e-4;
constexpr std::size_t kBins = 100'000;  // the last one takes all above

}  // namespace

DepthCheck::DepthCheck(const SurfelMap& map) : map_(map), histogram_(kBins) {}

void DepthCheck::add(const RgbdFrame& frame, const cv::Mat& mask,
                     const Eigen::Isometry3d& T_map_camera) {
  RenderOptions options;
  options.age = SurfelAge::all;
  renderer_.render(map_, frame.camera, T_map_camera, options, view_);
  depthInMetres(frame, kLeastDepth_m, kMostDepth_m, depth_m_);
  if (!mask.empty()) depth_m_.setTo(0, mask != 0);
  ++frames_;
  for (int v = 0; v < depth_m_.rows; ++v) {
    for (int u = 0; u < depth_m_.cols; ++u) {
      const float measured = depth_m_.at<float>(v, u), modelled = view_.depth_m.at<float>(v, u);
      if (measured <= 0) continue;
      ++measured_;
      if (modelled <= 0) continue;
      ++pixels_;
      const auto bin = static_cast<std::size_t>(std::abs(measured - modelled) / kBin_m);
      ++histogram_[std::min(bin, kBins - 1)];
    }
  }
}

double DepthCheck::coverage() const {
  return measured_ > 0 ? static_cast<double>(pixels_) / static_cast<double>(measured_) : 0.0;
}

double DepthCheck::medianM() const {
  std::size_t below = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    below += histogram_[bin];
    if (2 * below >= pixels_ && pixels_ > 0) return (static_cast<double>(bin) + 0.5) * kBin_m;
  }
  return 0.0;
}

PeopleCheck::PeopleCheck(const SurfelArrays& surfels, double tolerance_m)
    : surfels_(surfels),
      tolerance_m_(tolerance_m),
      on_mask_(surfels.size()),
      beside_(surfels.size()) {}

void PeopleCheck::add(const RgbdFrame& frame, const cv::Mat& mask,
                      const Eigen::Isometry3d& T_map_camera) {
  depthInMetres(frame, kLeastDepth_m, kMostDepth_m, depth_m_);
  const Eigen::Isometry3d T_camera_map = T_map_camera.inverse();
  parallelFor(surfels_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d point =
          T_camera_map * Eigen::Vector3d(surfels_.x[i], surfels_.y[i], surfels_.z[i]);
      if (point.z() < kLeastDepth_m) continue;
      const Eigen::Vector2d pixel = frame.camera.project(point);
      const auto u = static_cast<int>(std::lround(pixel.x()));
      const auto v = static_cast<int>(std::lround(pixel.y()));
      if (u < 0 || v < 0 || u >= depth_m_.cols || v >= depth_m_.rows) continue;
      const float measured = depth_m_.at<float>(v, u);
      if (measured <= 0 || std::abs(measured - point.z()) > tolerance_m_) continue;
      ++(mask.at<std::uint8_t>(v, u) != 0 ? on_mask_ : beside_)[i];
    }
  });
}

std::size_t PeopleCheck::onPeople() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < surfels(); ++i) count += isOnPerson(i) ? 1 : 0;
  return count;
}

double PeopleCheck::part() const {
  return surfels() > 0 ? static_cast<double>(onPeople()) / static_cast<double>(surfels()) : 0.0;
}

void ViewCheck::add(const RgbdFrame& frame, const cv::Mat& mask, bool has_pose) {
  depthInMetres(frame, kLeastDepth_m, kMostDepth_m, depth_m_);
  depth_m_.setTo(0, mask != 0);
  if (cv::countNonZero(depth_m_) < kEnough * static_cast<double>(depth_m_.total())) return;
  ++frames_;
  posed_ += has_pose ? 1 : 0;
}

}  // namespace pf

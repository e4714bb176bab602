// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/seen_before.hpp"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

// Of frames closer together than this, one is kept.
constexpr double kApart_s = 0.08;
constexpr double kKept_s = 1.3;
// A moment may be so much older or younger than it was asked for.
constexpr double kAgeOff_s = 0.15;

ModelView viewOf(const SceneGrid& grid, const PinholeCamera& camera, std::int64_t stamp_ns) {
  ModelView view;
  view.stamp_ns = stamp_ns;
  view.camera = camera.shrunk(grid.step);
  view.camera.width = grid.cols;
  view.camera.height = grid.rows;
  view.depth_m = cv::Mat(grid.rows, grid.cols, CV_32FC1);
  std::copy(grid.z.begin(), grid.z.end(), view.depth_m.begin<float>());
  return view;
}

}  // namespace

void SeenBefore::add(const SceneGrid& grid, const PinholeCamera& camera, std::int64_t stamp_ns) {
  if (!kept_.empty() &&
      (stamp_ns <= kept_.back().view.stamp_ns || kept_.back().view.camera.width != grid.cols)) {
    kept_.clear();
  }
  while (!kept_.empty() && secondsBetween(kept_.front().view.stamp_ns, stamp_ns) > kKept_s) {
    kept_.pop_front();
  }
  if (!kept_.empty() && secondsBetween(kept_.back().view.stamp_ns, stamp_ns) < kApart_s) return;
  kept_.push_back({viewOf(grid, camera, stamp_ns), false});
}

void SeenBefore::know(const ModelView& view) {
  if (view.fragment != fragment_) kept_.clear();
  fragment_ = view.fragment;
  for (Moment& moment : kept_) {
    if (moment.view.stamp_ns != view.stamp_ns) continue;
    moment.view.T_map_camera = view.T_uncorrected_camera();
    moment.is_located = true;
  }
}

const SeenBefore::Moment* SeenBefore::nearestTo(std::int64_t stamp_ns) const {
  const Moment* nearest = nullptr;
  double least_s = kAgeOff_s;
  for (const Moment& moment : kept_) {
    const double off_s = std::abs(secondsBetween(moment.view.stamp_ns, stamp_ns));
    if (!moment.is_located || off_s > least_s) continue;
    least_s = off_s;
    nearest = &moment;
  }
  return nearest;
}

void SeenBefore::compare(const SceneGrid& grid, const std::vector<int>& cells,
                         const Eigen::Isometry3d& T_uncorrected_camera, std::int64_t stamp_ns,
                         const DepthSensor& sensor) {
  for (std::size_t i = 0; i < kAges_s.size(); ++i) {
    const auto age_ns = static_cast<std::int64_t>(kAges_s[i] * 1e9);
    const Moment* moment = nearestTo(stamp_ns - age_ns);
    if (moment == nullptr) {
      moments_[i].assign(grid.size(), Background::unknown);
      continue;
    }
    const Eigen::Isometry3d T_view_camera =
        moment->view.T_map_camera.inverse() * T_uncorrected_camera;
    compareWithModel(grid, cells, moment->view, T_view_camera, sensor, moments_[i]);
  }
}

bool SeenBefore::said(int cell, Background what) const {
  for (const std::vector<Background>& moment : moments_) {
    if (moment[static_cast<std::size_t>(cell)] == what) return true;
  }
  return false;
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/place_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "posefusion/core/point_grid.hpp"
#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

constexpr float kNear_m = 0.05F;       // a surfel so near to a point maps it
constexpr double kAgrees_m = 0.05;     // depth that differs by less shows the point, by more lies
                                       // behind it
constexpr double kNearest_m = 0.3;     // of a point to the camera
constexpr double kSeenOfLeft = 0.5;    // of the known points
constexpr double kSeenOfTaken = 0.15;  // of all points: a thing shows one or two of its sides
constexpr std::size_t kLeastTaken = 30;
constexpr double kForgotten = 0.1, kMapped = 0.5;  // of the known points

std::size_t count(const std::vector<char>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
}

std::size_t countBoth(const std::vector<char>& a, const std::vector<char>& b) {
  std::size_t both = 0;
  for (std::size_t i = 0; i < a.size(); ++i) both += a[i] != 0 && b[i] != 0 ? 1 : 0;
  return both;
}

double share(std::size_t part, std::size_t of) {
  return of > 0 ? static_cast<double>(part) / static_cast<double>(of) : 0.0;
}

}  // namespace

PlaceWatch::PlaceWatch(Kind kind, std::vector<Eigen::Vector3d> points)
    : kind_(kind),
      points_(std::move(points)),
      known_(points_.size(), 0),
      shown_(points_.size(), 0),
      shown_now_(points_.size(), 0),
      mapped_(points_.size(), 0) {}

std::size_t PlaceWatch::known() const { return count(known_); }

double PlaceWatch::mapped() const { return share(countBoth(known_, mapped_), known()); }

bool PlaceWatch::isSeen() const {
  const std::size_t shown = countBoth(known_, shown_);
  if (kind_ == Kind::left) return known() > 0 && share(shown, known()) >= kSeenOfLeft;
  return shown >= kLeastTaken && share(shown, points_.size()) >= kSeenOfTaken;
}

double PlaceWatch::shownOfWrong() const {
  std::size_t wrong = 0, shown = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (known_[i] == 0 || (mapped_[i] != 0) == (kind_ == Kind::taken)) continue;
    ++wrong;
    shown += shown_now_[i] != 0 ? 1 : 0;
  }
  return share(shown, wrong);
}

void PlaceWatch::look(const MappedView& view) {
  const Eigen::Isometry3d T_camera_world = view.T_world_camera.inverse();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    shown_now_[i] = 0;
    const Eigen::Vector3d p = T_camera_world * points_[i];
    if (p.z() < kNearest_m) continue;
    const Eigen::Vector2d pixel = view.camera.project(p);
    const auto u = static_cast<int>(std::lround(pixel.x()));
    const auto v = static_cast<int>(std::lround(pixel.y()));
    if (u < 0 || v < 0 || u >= view.depth_m.cols || v >= view.depth_m.rows) continue;
    const double beyond = view.depth_m.at<float>(v, u) - p.z();
    const bool shows = kind_ == Kind::left ? beyond > kAgrees_m : std::abs(beyond) <= kAgrees_m;
    if (shows) shown_[i] = shown_now_[i] = 1;
  }
}

void PlaceWatch::findSurfels(const MappedView& view) {
  Eigen::AlignedBox3f box;
  std::vector<Eigen::Vector3f> places;
  for (const Eigen::Vector3d& p : points_) {
    places.emplace_back((view.T_map_world * p).cast<float>());
    box.extend(places.back());
  }
  const Eigen::Vector3f reach = Eigen::Vector3f::Constant(kNear_m);
  const Eigen::AlignedBox3f around(box.min() - reach, box.max() + reach);
  std::vector<Eigen::Vector3f> surfels;
  for (const SurfelBlock& block : view.map.blocks()) {
    if (block.fragment != kFirstFragment || !block.bounds.intersects(around)) continue;
    const SurfelArrays& s = block.surfels;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Eigen::Vector3f at(s.x[i], s.y[i], s.z[i]);
      if (!around.contains(at) || !view.map.isStable(s, i) || view.map.isDead(s, i)) continue;
      surfels.push_back(at);
    }
  }
  const PointGrid grid(surfels);
  for (std::size_t i = 0; i < places.size(); ++i) {
    bool near = false;
    grid.visit({places[i] - reach, places[i] + reach},
               [&](std::size_t k) { near = near || (surfels[k] - places[i]).norm() <= kNear_m; });
    mapped_[i] = near ? 1 : 0;
  }
}

void PlaceWatch::add(const MappedView& view) {
  if (points_.empty() || told_ns_) return;
  const std::int64_t before_ns = std::exchange(last_ns_, view.stamp_ns);
  if (kind_ == Kind::left && !std::exchange(begun_, true)) {
    findSurfels(view);
    known_ = mapped_;
    return;
  }
  look(view);
  if (kind_ == Kind::taken) known_ = shown_;
  if (seen_ns_) in_view_s_ += secondsBetween(before_ns, view.stamp_ns) * shownOfWrong();
  findSurfels(view);
  if (!seen_ns_ && isSeen()) seen_ns_ = view.stamp_ns;
  if (!seen_ns_) return;
  const bool shown = kind_ == Kind::left ? mapped() <= kForgotten : mapped() >= kMapped;
  if (shown) told_ns_ = view.stamp_ns;
}

}  // namespace pf

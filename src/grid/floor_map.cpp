// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/grid/floor_map.hpp"

#include <algorithm>
#include <utility>

#include "posefusion/core/se3.hpp"
#include "posefusion/grid/floor.hpp"
#include "posefusion/map/stable_surfels.hpp"

namespace pf {
namespace {

constexpr std::size_t kNewest = 8;
// A floor is taken for the one before, by how the frame on it is placed.
constexpr double kSameFloor_m = 0.01, kSameFloor_rad = 0.003;
// A keyframe that was moved by less sees the same.
constexpr double kSamePlace_m = 0.01, kSamePlace_rad = 0.005;

SeenPoints moved(const Eigen::Isometry3d& T_out_in, const SeenPoints& seen) {
  const Eigen::Isometry3f T = T_out_in.cast<float>();
  SeenPoints out{T * seen.from, seen.points};
  for (Eigen::Vector3f& p : out.points) p = T * p;
  return out;
}

}  // namespace

double FloorMap::leaning_rad() const { return angleOf(T_floor_world); }

FloorMap floorMapOf(const MapParts& parts) {
  FloorMap out;
  out.T_floor_world = floorFrame(stableSurfels(parts.map, parts.T_world_map));
  const Eigen::Isometry3d T_floor_map = out.T_floor_world * parts.T_world_map;
  out.surfels = stableSurfels(parts.map, T_floor_map);
  forEachKeyframe(parts.map, parts.camera, parts.keyframes,
                  [&](const SeenPoints& seen) { out.seen.push_back(moved(T_floor_map, seen)); });
  return out;
}

OccupancyGrid gridOf(const FloorMap& map, const GridConfig& config) {
  GridMaker maker(map.surfels, config);
  for (const SeenPoints& seen : map.seen) maker.add(seen);
  return maker.grid();
}

GrowingGrid::GrowingGrid(const GridConfig& config) : config_(config) { validate(config); }

/// What keyframe i sees, where that is not known.
void GrowingGrid::draw(const MapParts& parts, KeyframeRays& rays, std::size_t i) {
  const Eigen::Isometry3d& T = parts.keyframes[i].T_map_camera;
  const bool is_new = i + kNewest >= parts.keyframes.size();
  const bool is_drawn = !seen_[i].depth_mm.empty() &&
                        isWithin(seen_[i].T_map_camera.inverse() * T, kSamePlace_m, kSamePlace_rad);
  if (is_drawn && !is_new) return;
  seen_[i].T_map_camera = T;
  rays.draw(parts.map, T).convertTo(seen_[i].depth_mm, CV_16UC1, 1000);
}

std::optional<GrowingGrid::Placed> GrowingGrid::update(const MapParts& parts,
                                                       const std::function<bool()>& stops) {
  const Eigen::Isometry3d T_new = floorFrame(stableSurfels(parts.map, parts.T_world_map));
  if (!T_floor_world_ || !isWithin(*T_floor_world_ * T_new.inverse(), kSameFloor_m, kSameFloor_rad))
    T_floor_world_ = T_new;
  const Eigen::Isometry3d T_floor_map = *T_floor_world_ * parts.T_world_map;
  GridMaker maker(stableSurfels(parts.map, T_floor_map), config_);
  seen_.resize(parts.keyframes.size());  // fewer: another map
  KeyframeRays rays(parts.camera);
  cv::Mat depth_m;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const Keyframe& keyframe = parts.keyframes[i];
    if (stops && stops()) return std::nullopt;
    if (keyframe.fragment != kFirstFragment || keyframe.isRetired()) {
      seen_[i] = {};
      continue;
    }
    draw(parts, rays, i);
    seen_[i].depth_mm.convertTo(depth_m, CV_32FC1, 1e-3);
    maker.add(moved(T_floor_map, rays.points(depth_m, keyframe.T_map_camera)));
  }
  return Placed{maker.grid(), T_floor_world_->inverse()};
}

}  // namespace pf

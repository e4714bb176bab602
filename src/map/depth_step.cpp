// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/depth_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "posefusion/core/parallel.hpp"
#include "posefusion/core/rigid_motion.hpp"
#include "ray_field.hpp"

namespace pf {
namespace {

constexpr float kNearest_m = 0.1F;  // before the camera; nearer nothing is measured

// What knows a surfel by less than this part of what the other keyframe does has no say.
constexpr float kLeastPart = 0.05F;

/// A keyframe as a camera: where it is, and where it was.
struct View {
  std::int32_t map_frame;
  RigidMotion T_map_camera, T_camera_before;
};

/// The keyframes of a fragment by the frame that they were fused in.
using Views = std::vector<View>;

std::map<int, Views> viewsOf(const DepthStep& step) {
  std::map<int, Views> of;
  for (const Keyframe& k : step.keyframes) {
    const Eigen::Isometry3d T_now_before = step.motion.at(k.map_frame, k.fragment);
    of[k.fragment].push_back({k.map_frame, RigidMotion(k.T_map_camera),
                              RigidMotion(k.T_map_camera.inverse() * T_now_before)});
  }
  for (auto& [fragment, views] : of) {
    std::stable_sort(views.begin(), views.end(),
                     [](const View& a, const View& b) { return a.map_frame < b.map_frame; });
  }
  return of;
}

/// The last of the views that is no later than a frame, or the first; and the frames of which that
/// is so.
class LastView {
 public:
  explicit LastView(const Views& views) : views_(views) {}

  std::size_t at(std::int32_t map_frame) {
    if (map_frame >= begin_ && map_frame < end_) return index_;
    const auto after =
        std::upper_bound(views_.begin(), views_.end(), map_frame,
                         [](std::int32_t frame, const View& v) { return frame < v.map_frame; });
    const bool is_before_all = after == views_.begin();
    index_ = is_before_all ? 0 : static_cast<std::size_t>(after - views_.begin()) - 1;
    begin_ = is_before_all ? std::numeric_limits<std::int32_t>::min() : views_[index_].map_frame;
    end_ = after == views_.end() ? std::numeric_limits<std::int32_t>::max() : after->map_frame;
    return index_;
  }

 private:
  const Views& views_;
  std::size_t index_ = 0;
  std::int32_t begin_ = 0, end_ = 0;
};

/// Surfels of a run, in the map, or as a keyframe has them.
struct Surfels {
  static constexpr int kMost = 64;  // at once
  float x[kMost], y[kMost], z[kMost], nx[kMost], ny[kMost], nz[kMost];
  float weight[kMost];  // 0: not seen
  float z_m[kMost];     // before they were moved
  float factor[kMost];  // of their depth; 1: they stay
};

/// From a view, weighed, and moved as the field moves what its camera sees. The plane N . X = 1 at
/// the point has the inverse depth N . (x, y, 1) along the ray (x, y, 1); the field is added to
/// that, and so, to first order, its slopes to N.
POSEFUSION_SIMD_CLONES
void look(const RayField& of, const View& view, const Surfels& surfels, int count,
          Surfels& result) {
  const RayField field = of;
  const RigidMotion to = view.T_camera_before, back = view.T_map_camera;
  Surfels seen;  // which nothing else points to: the compiler may use vectors
  for (int i = 0; i < count; ++i) {
    float px, py, pz, nx, ny, nz;
    to.point(surfels.x[i], surfels.y[i], surfels.z[i], px, py, pz);
    to.direction(surfels.nx[i], surfels.ny[i], surfels.nz[i], nx, ny, nz);
    const bool is_before = pz >= kNearest_m;
    const float inverse_z = 1.0F / (is_before ? pz : 1.0F);
    const float x = px * inverse_z, y = py * inverse_z;
    const float distance = nx * px + ny * py + nz * pz;
    const float inverse_z2 = inverse_z * inverse_z;
    const bool is_seen = is_before & (distance < 0) & field.isInside(x, y);
    seen.weight[i] = is_seen ? inverse_z2 * inverse_z2 : 0.0F;
    seen.z_m[i] = pz;
    const RayField::Value f = field.at(x, y);
    const float inverse = 1.0F + pz * f.d;
    const bool moves = is_before & (inverse > 0);
    const bool bends = moves & (distance != 0);
    const float factor = 1.0F / (moves ? inverse : 1.0F);
    const float per = 1.0F / (distance != 0 ? distance : 1.0F);
    const float bx = nx * per + f.by_x, by = ny * per + f.by_y;
    const float bz = nz * per + (f.d - f.by_x * x - f.by_y * y);
    const float scale = (distance < 0 ? -1.0F : 1.0F) / std::sqrt(bx * bx + by * by + bz * bz);
    seen.factor[i] = factor;
    back.point(px * factor, py * factor, pz * factor, seen.x[i], seen.y[i], seen.z[i]);
    back.direction(bends ? bx * scale : nx, bends ? by * scale : ny, bends ? bz * scale : nz,
                   seen.nx[i], seen.ny[i], seen.nz[i]);
  }
  result = seen;
}

/// A mean over frames knows no better than what all of them are off by: the variance of a
/// measurement at 1 m, over that of what is left at 1 m; at z m it is 1/z^4 of that (in units of
/// surfels).
float mostWeightAt1m(const DepthStep& step) {
  const double at_1_m = step.sensor.sigma(1.0F);
  return step.left_per_m > 0
             ? static_cast<float>(at_1_m * at_1_m / (step.left_per_m * step.left_per_m))
             : std::numeric_limits<float>::max();
}

/// What the keyframes of their making and of their last support make of surfels. Of those between,
/// only a drawing of the map could tell which saw them, and which looked at a wall before them.
/// The keyframe of their making counts also where a surfel lies outside of its picture: frames
/// after it have seen it.
POSEFUSION_SIMD_CLONES
void join(Surfels& a, const Surfels& b, int count) {
  for (int i = 0; i < count; ++i) {
    const float of_a = a.weight[i] + b.weight[i] > 0 ? a.weight[i] : 1.0F, of_b = b.weight[i];
    const float least = kLeastPart * std::max(of_a, of_b);
    const float wa = of_a > least ? of_a : 0.0F, wb = of_b > least ? of_b : 0.0F;
    const float per = 1.0F / (wa + wb), pa = wa * per, pb = wb * per;
    a.x[i] = pa * a.x[i] + pb * b.x[i];
    a.y[i] = pa * a.y[i] + pb * b.y[i];
    a.z[i] = pa * a.z[i] + pb * b.z[i];
    const float nx = pa * a.nx[i] + pb * b.nx[i], ny = pa * a.ny[i] + pb * b.ny[i];
    const float nz = pa * a.nz[i] + pb * b.nz[i];
    const float length = std::sqrt(nx * nx + ny * ny + nz * nz);
    const float scale = 1.0F / (length > 0 ? length : 1.0F);
    a.nx[i] = nx * scale;
    a.ny[i] = ny * scale;
    a.nz[i] = nz * scale;
    a.factor[i] = pa * a.factor[i] + pb * b.factor[i];
    a.z_m[i] = of_b > of_a ? b.z_m[i] : a.z_m[i];
  }
}

/// Corrects surfels [begin, begin + count) by their two views.
void correctSome(const RayField& field, const View& first, const View& last, float most_weight,
                 std::size_t begin, int count, SurfelArrays& s) {
  Surfels surfels{}, seen{}, again{};
  for (int i = 0; i < count; ++i) {
    const std::size_t k = begin + static_cast<std::size_t>(i);
    surfels.x[i] = s.x[k], surfels.y[i] = s.y[k], surfels.z[i] = s.z[k];
    surfels.nx[i] = s.nx[k], surfels.ny[i] = s.ny[k], surfels.nz[i] = s.nz[k];
  }
  look(field, first, surfels, count, seen);
  if (&first != &last) {
    look(field, last, surfels, count, again);
    join(seen, again, count);
  }
  for (int i = 0; i < count; ++i) {
    const std::size_t k = begin + static_cast<std::size_t>(i);
    s.x[k] = seen.x[i], s.y[k] = seen.y[i], s.z[k] = seen.z[i];
    s.nx[k] = seen.nx[i], s.ny[k] = seen.ny[i], s.nz[k] = seen.nz[i];
    s.radius[k] *= seen.factor[i];
    const float z_m2 = seen.z_m[i] * seen.z_m[i];
    s.weight[k] = std::min(s.weight[k], most_weight / (z_m2 * z_m2));
  }
}

/// The surfels of a block, in runs of the same two views.
void correctBlock(const RayField& field, const Views& views, float most_weight, SurfelArrays& s) {
  LastView made(views), supported(views);
  for (std::size_t i = 0, end = 0; i < s.size(); i = end) {
    const auto viewsAt = [&](std::size_t k) {
      const std::size_t first = made.at(s.created[k]);
      return std::pair(first, std::max(first, supported.at(s.seen[k])));
    };
    const auto [first, last] = viewsAt(i);
    do {
      ++end;
    } while (end < s.size() && end - i < Surfels::kMost && viewsAt(end) == std::pair(first, last));
    correctSome(field, views[first], views[last], most_weight, i, static_cast<int>(end - i), s);
  }
}

}  // namespace

void correctDepth(SurfelMap& map, const DepthStep& step) {
  correctDepth(map, step, allBlocks(map));
}

void correctDepth(SurfelMap& map, const DepthStep& step, const std::vector<std::uint32_t>& blocks) {
  const std::map<int, Views> views = viewsOf(step);
  const std::vector<float> nodes(step.field.nodes().begin(), step.field.nodes().end());
  const RayField field(step.field, step.camera, nodes);
  const float most_weight = mostWeightAt1m(step);
  map.move({[&](const SurfelBlock& block) { return block.surfels.size() > 0; },
            [&](SurfelArrays& surfels, int fragment) {
              const auto of = views.find(fragment);
              if (of != views.end()) correctBlock(field, of->second, most_weight, surfels);
            }},
           blocks);
}

}  // namespace pf

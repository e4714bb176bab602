// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/depth_step.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace pf {
namespace {

constexpr double kNearest_m = 0.1;  // before the camera; nearer nothing is measured

/// The keyframes of each fragment by the frame that they were fused in.
class Origins {
 public:
  explicit Origins(const std::vector<Keyframe>& keyframes) {
    for (const Keyframe& k : keyframes) of_[k.fragment].push_back(&k);
    for (auto& [fragment, list] : of_) {
      std::stable_sort(list.begin(), list.end(),
                       [](auto* a, auto* b) { return a->map_frame < b->map_frame; });
    }
  }

  const Keyframe* at(int fragment, std::int32_t map_frame) const {
    const auto found = of_.find(fragment);
    if (found == of_.end()) return nullptr;
    const auto& list = found->second;
    const auto after =
        std::upper_bound(list.begin(), list.end(), map_frame,
                         [](std::int32_t frame, auto* k) { return frame < k->map_frame; });
    return after == list.begin() ? list.front() : *(after - 1);
  }

 private:
  std::map<int, std::vector<const Keyframe*>> of_;
};

/// How a field moves what one camera sees.
class RayMotion {
 public:
  RayMotion(const DepthField& field, const PinholeCamera& camera)
      : field_(field), camera_(camera) {}

  /// Point and normal in the camera frame. The plane N . X = 1 at the point has the inverse depth
  /// N . (x, y, 1) along the ray (x, y, 1); the field is added to that, and so, to first order, its
  /// slopes to N. Returns the factor of the depth; 0: nothing has moved.
  double apply(Eigen::Vector3d& p, Eigen::Vector3d& n) const {
    if (p.z() < kNearest_m) return 0;
    const double x = p.x() / p.z(), y = p.y() / p.z();
    const FieldWeights w = field_.weights((camera_.fx * x + camera_.cx + 0.5) / camera_.width,
                                          (camera_.fy * y + camera_.cy + 0.5) / camera_.height);
    double by_x = 0, by_y = 0;
    for (std::size_t k = 0; k < FieldWeights::kNodes; ++k) {
      const double node = field_.nodes()[static_cast<std::size_t>(w.node[k])];
      by_x += w.by_x[k] * node * camera_.fx / camera_.width;
      by_y += w.by_y[k] * node * camera_.fy / camera_.height;
    }
    const double d = field_.at(w), factor = 1.0 / (1.0 + p.z() * d);
    if (!(factor > 0)) return 0;
    const double distance = n.dot(p);
    if (distance != 0) {
      const Eigen::Vector3d N = n / distance;
      const Eigen::Vector3d bent(N.x() + by_x, N.y() + by_y, N.z() + d - by_x * x - by_y * y);
      n = bent.normalized() * (distance < 0 ? -1 : 1);
    }
    p *= factor;
    return factor;
  }

 private:
  const DepthField& field_;
  const PinholeCamera& camera_;
};

/// A mean over frames knows no better than what all of them are off by. In units of surfels: the
/// variance of a measurement at 1 m, over that of what is left at z.
float mostWeight(const DepthStep& step, double z_m) {
  const double left_m = step.left_per_m * z_m * z_m;
  const double at_1_m = step.sensor.sigma(1.0F);
  return left_m > 0 ? static_cast<float>(at_1_m * at_1_m / (left_m * left_m))
                    : std::numeric_limits<float>::max();
}

void correct(SurfelArrays& s, int fragment, const DepthStep& step, const Origins& origins,
             const RayMotion& motion) {
  const Keyframe* keyframe = nullptr;
  Eigen::Isometry3d T_camera_map = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Keyframe* origin = origins.at(fragment, s.created[i]);
    if (origin == nullptr) return;
    if (origin != keyframe) T_camera_map = origin->T_map_camera.inverse();
    keyframe = origin;
    Eigen::Vector3d p = T_camera_map * Eigen::Vector3d(s.x[i], s.y[i], s.z[i]);
    Eigen::Vector3d n = T_camera_map.linear() * Eigen::Vector3d(s.nx[i], s.ny[i], s.nz[i]);
    const double factor = motion.apply(p, n);
    if (factor == 0) continue;
    const Eigen::Vector3f at = (origin->T_map_camera * p).cast<float>();
    const Eigen::Vector3f normal = (origin->T_map_camera.linear() * n).cast<float>();
    s.x[i] = at.x();
    s.y[i] = at.y();
    s.z[i] = at.z();
    s.nx[i] = normal.x();
    s.ny[i] = normal.y();
    s.nz[i] = normal.z();
    s.radius[i] *= static_cast<float>(factor);
    s.weight[i] = std::min(s.weight[i], mostWeight(step, p.z()));
  }
}

}  // namespace

void correctDepth(SurfelMap& map, const DepthStep& step) {
  correctDepth(map, step, allBlocks(map));
}

void correctDepth(SurfelMap& map, const DepthStep& step, const std::vector<std::uint32_t>& blocks) {
  const Origins origins(step.keyframes);
  const RayMotion motion(step.field, step.camera);
  map.move({[&](const SurfelBlock& block) { return block.surfels.size() > 0; },
            [&](SurfelArrays& surfels, int fragment) {
              correct(surfels, fragment, step, origins, motion);
            }},
           blocks);
}

}  // namespace pf

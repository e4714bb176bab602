// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/depth_step.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

namespace pf {
namespace {

constexpr double kNearest_m = 0.1;  // before the camera; nearer nothing is measured

// What knows a surfel by less than this part of what the other keyframe does has no say.
constexpr double kLeastPart = 0.05;

/// A keyframe as a camera: where it is, and where it was.
struct View {
  std::int32_t map_frame;
  Eigen::Isometry3d T_map_camera, T_camera_before;
};

/// The keyframes of each fragment by the frame that they were fused in.
class Views {
 public:
  explicit Views(const DepthStep& step) {
    for (const Keyframe& k : step.keyframes) {
      const Eigen::Isometry3d T_now_before = step.motion.at(k.map_frame, k.fragment);
      of_[k.fragment].push_back(
          {k.map_frame, k.T_map_camera, k.T_map_camera.inverse() * T_now_before});
    }
    for (auto& [fragment, list] : of_) {
      std::stable_sort(list.begin(), list.end(),
                       [](const View& a, const View& b) { return a.map_frame < b.map_frame; });
    }
  }

  /// By map_frame; nullptr: the fragment has none.
  const std::vector<View>* of(int fragment) const {
    const auto found = of_.find(fragment);
    return found == of_.end() ? nullptr : &found->second;
  }

  /// The last one that is no later than a frame, or the first.
  static std::size_t lastAt(const std::vector<View>& views, std::int32_t map_frame) {
    const auto after =
        std::upper_bound(views.begin(), views.end(), map_frame,
                         [](std::int32_t frame, const View& v) { return frame < v.map_frame; });
    return after == views.begin() ? 0 : static_cast<std::size_t>(after - views.begin()) - 1;
  }

 private:
  std::map<int, std::vector<View>> of_;
};

/// How a field moves what one camera sees.
class RayMotion {
 public:
  RayMotion(const DepthField& field, const PinholeCamera& camera)
      : field_(field), camera_(camera) {}

  /// Point and normal in the camera frame. The plane N . X = 1 at the point has the inverse depth
  /// N . (x, y, 1) along the ray (x, y, 1); the field is added to that, and so, to first order, its
  /// slopes to N. Returns the factor of the depth; 1: it stays.
  double apply(Eigen::Vector3d& p, Eigen::Vector3d& n) const {
    if (p.z() < kNearest_m) return 1;
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
    if (!(factor > 0)) return 1;
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

/// A surfel from one keyframe.
struct Seen {
  const View* view;
  Eigen::Vector3d p, n;  // in its camera frame
  double weight;         // 0: not seen
};

/// A surfel, and what the keyframes of its making and of its last support make of it. Of those
/// between, only a drawing of the map could tell which saw it, and which looked at a wall before
/// it.
class SurfelStep {
 public:
  SurfelStep(const DepthStep& step, const RayMotion& motion) : step_(step), motion_(motion) {}

  void correct(const std::vector<View>& views, SurfelArrays& s, std::size_t i) const {
    std::array<Seen, 2> seen = look(views, s, i);
    const double best = std::max(seen[0].weight, seen[1].weight);
    double sum = 0, factor = 0, nearest_m = 0;
    Eigen::Vector3d at = Eigen::Vector3d::Zero(), normal = at;
    for (Seen& one : seen) {
      if (one.weight <= kLeastPart * best) continue;
      const double by = motion_.apply(one.p, one.n);
      if (one.weight == best) nearest_m = one.p.z();
      sum += one.weight;
      factor += one.weight * by;
      at += one.weight * (one.view->T_map_camera * one.p);
      normal += one.weight * (one.view->T_map_camera.linear() * one.n);
    }
    at /= sum;
    normal.normalize();
    s.x[i] = static_cast<float>(at.x());
    s.y[i] = static_cast<float>(at.y());
    s.z[i] = static_cast<float>(at.z());
    s.nx[i] = static_cast<float>(normal.x());
    s.ny[i] = static_cast<float>(normal.y());
    s.nz[i] = static_cast<float>(normal.z());
    s.radius[i] *= static_cast<float>(factor / sum);
    s.weight[i] = std::min(s.weight[i], mostWeight(step_, nearest_m));
  }

 private:
  /// The keyframe of its making counts also where the surfel lies outside of its picture: frames
  /// after it have seen it.
  std::array<Seen, 2> look(const std::vector<View>& views, const SurfelArrays& s,
                           std::size_t i) const {
    const std::size_t first = Views::lastAt(views, s.created[i]);
    const std::size_t last = std::max(first, Views::lastAt(views, s.seen[i]));
    const Eigen::Vector3d at(s.x[i], s.y[i], s.z[i]), normal(s.nx[i], s.ny[i], s.nz[i]);
    const auto from = [&](const View& view) {
      const Eigen::Vector3d p = view.T_camera_before * at;
      const Eigen::Vector3d n = view.T_camera_before.linear() * normal;
      return Seen{&view, p, n, isSeen(p, n) ? 1.0 / (p.z() * p.z() * p.z() * p.z()) : 0.0};
    };
    std::array<Seen, 2> seen = {from(views[first]), from(views[last])};
    if (first == last) seen[1].weight = 0;
    if (seen[0].weight + seen[1].weight == 0) seen[0].weight = 1;
    return seen;
  }

  bool isSeen(const Eigen::Vector3d& p, const Eigen::Vector3d& n) const {
    if (p.z() < kNearest_m || n.dot(p) >= 0) return false;
    const Eigen::Vector2d pixel = step_.camera.project(p);
    return pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < step_.camera.width - 0.5 &&
           pixel.y() < step_.camera.height - 0.5;
  }

  const DepthStep& step_;
  const RayMotion& motion_;
};

}  // namespace

void correctDepth(SurfelMap& map, const DepthStep& step) {
  correctDepth(map, step, allBlocks(map));
}

void correctDepth(SurfelMap& map, const DepthStep& step, const std::vector<std::uint32_t>& blocks) {
  const Views views(step);
  const RayMotion motion(step.field, step.camera);
  const SurfelStep surfel(step, motion);
  map.move({[&](const SurfelBlock& block) { return block.surfels.size() > 0; },
            [&](SurfelArrays& surfels, int fragment) {
              const std::vector<View>* of = views.of(fragment);
              if (of == nullptr) return;
              for (std::size_t i = 0; i < surfels.size(); ++i) surfel.correct(*of, surfels, i);
            }},
           blocks);
}

}  // namespace pf

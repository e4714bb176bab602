// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/dense_pairs.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "posefusion/calibration/view_pairs.hpp"
#include "posefusion/core/parallel.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

// Of a keyframe, with later ones: each pair is some milliseconds of work, and more pairs hardly add
// information.
constexpr std::size_t kPairsOfView = 8;

const KeyframeView* find(const std::vector<const KeyframeView*>& views, int id) {
  const auto found = std::lower_bound(views.begin(), views.end(), id,
                                      [](auto* view, int number) { return view->id < number; });
  return found != views.end() && (*found)->id == id ? *found : nullptr;
}

/// Buffers of one thread.
struct PairMeasurer {
  KeyframePicture from, to;
  PairAligner aligner;

  std::optional<PoseConstraint> measure(const PoseConstraint& pair, const KeyframeView& a,
                                        const KeyframeView& b, const DepthSensor& sensor) {
    from.assign(a, sensor);
    to.assign(b, sensor);
    const PlaceVerdict forth = aligner.align(from, to, pair.T_from_to);
    if (!forth.accepted()) return std::nullopt;
    const Eigen::Isometry3d T = forth.alignment.T_map_camera;
    if (!aligner.confirms(from, to, T)) return std::nullopt;
    return PoseConstraint{pair.from, pair.to, T, forth.alignment.covariance, pair.kind};
  }
};

}  // namespace

CalibrationView calibrationView(const KeyframeView& view, const DepthSensor& sensor) {
  CalibrationView seen;
  seen.id = static_cast<int>(view.id);
  seen.camera = view.camera;
  seen.T_map_camera = view.pose.T_map_camera;
  seen.fragment = view.pose.fragment;
  seen.depth_mm = view.depth_mm;
  seen.sensor = sensor;
  return seen;
}

std::vector<PoseConstraint> measurePairs(const std::vector<const KeyframeView*>& views,
                                         const std::vector<PoseConstraint>& pairs,
                                         const TrackingConfig& tracking,
                                         const DepthSensor& sensor) {
  std::vector<std::optional<PoseConstraint>> found(pairs.size());
  parallelFor(pairs.size(), 8, [&](std::size_t begin, std::size_t end) {
    PairMeasurer measurer{{}, {}, PairAligner(tracking)};
    for (std::size_t i = begin; i < end; ++i) {
      const KeyframeView *from = find(views, pairs[i].from), *to = find(views, pairs[i].to);
      if (from == nullptr || to == nullptr) continue;
      found[i] = measurer.measure(pairs[i], *from, *to, sensor);
    }
  });
  std::vector<PoseConstraint> measured;
  for (const auto& one : found) {
    if (one) measured.push_back(*one);
  }
  return measured;
}

std::vector<PoseConstraint> densePairs(const std::vector<KeyframeView>& views,
                                       const std::vector<PoseConstraint>& known,
                                       const DepthSensor& sensor) {
  std::vector<ViewSurface> surfaces;
  for (const KeyframeView& view : views) surfaces.emplace_back(calibrationView(view, sensor));
  std::set<std::pair<int, int>> there;
  for (const PoseConstraint& c : known) there.insert(std::minmax(c.from, c.to));
  PairLimits limits;
  limits.most_per_view = kPairsOfView;
  limits.most_pairs = kPairsOfView * views.size();
  std::vector<PoseConstraint> pairs;
  for (const ViewPair& pair : overlappingPairs(surfaces, limits)) {
    const int from = surfaces[pair.from].id(), to = surfaces[pair.to].id();
    if (there.count({from, to}) > 0) continue;
    PoseConstraint constraint;
    constraint.from = from;
    constraint.to = to;
    constraint.T_from_to = pair.T_to_from.inverse();
    pairs.push_back(constraint);
  }
  return pairs;
}

}  // namespace pf

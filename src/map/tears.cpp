// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/tears.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "posefusion/core/parallel.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/map/layers.hpp"

namespace pf {
namespace {

// Motions that differ by less move no surfel from noise of one layer to another layer, but for few.
constexpr double kTear_m = kLeastLayer_m / 3.0;

using Keyframes = std::vector<std::uint32_t>;  // numbers, ascending

/// The keyframes that what was made in a fragment hangs on.
class Hangers {
 public:
  explicit Hangers(const std::vector<Keyframe>& keyframes) {
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      of_[keyframes[i].fragment].emplace_back(keyframes[i].map_frame, i);
    }
    for (auto& [fragment, list] : of_) std::sort(list.begin(), list.end());
  }

  /// Of a block: for each frame in it the keyframe before and the one after, between which it
  /// moves.
  Keyframes of(const SurfelBlock& block) const {
    Keyframes result;
    const auto found = of_.find(block.fragment);
    if (found == of_.end()) return result;
    const auto& list = found->second;
    std::int32_t last = -1;
    for (const std::int32_t frame : block.surfels.created) {
      if (frame == last && !result.empty()) continue;
      last = frame;
      const auto after = std::upper_bound(
          list.begin(), list.end(), frame,
          [](std::int32_t number, const auto& entry) { return number < entry.first; });
      const bool is_at_keyframe = after != list.begin() && (after - 1)->first == frame;
      if (after != list.begin()) result.push_back((after - 1)->second);
      if (after != list.end() && !is_at_keyframe) result.push_back(after->second);
    }
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

 private:
  std::map<int, std::vector<std::pair<std::int32_t, std::uint32_t>>> of_;  // by frame
};

/// Blocks along one axis: finds those close to one.
class BlocksAlong {
 public:
  explicit BlocksAlong(const SurfelMap& map) : map_(map) {
    for (const std::uint32_t i : allBlocks(map)) {
      const SurfelBlock& block = map.blocks()[i];
      if (block.surfels.size() == 0) continue;
      order_.push_back(i);
      longest_ = std::max(longest_, block.bounds.sizes().x());
      reach_ = std::max(reach_, kMostLayer_m + block.largest_radius);
    }
    std::sort(order_.begin(), order_.end(), [&](auto a, auto b) {
      return std::make_pair(low(a), a) < std::make_pair(low(b), b);
    });
  }

  /// Calls visit(block) for those of the same fragment whose layers could meet, itself too.
  template <typename Visit>
  void visitAround(std::uint32_t block, const Visit& visit) const {
    const SurfelBlock& center = map_.blocks()[block];
    const float first = center.bounds.min().x() - longest_ - reach_;
    auto at = std::partition_point(order_.begin(), order_.end(),
                                   [&](std::uint32_t i) { return low(i) < first; });
    for (; at != order_.end() && low(*at) <= center.bounds.max().x() + reach_; ++at) {
      const SurfelBlock& other = map_.blocks()[*at];
      if (other.fragment != center.fragment) continue;
      if (other.bounds.squaredExteriorDistance(center.bounds) <= reach_ * reach_) visit(*at);
    }
  }

  float reach() const { return reach_; }

 private:
  float low(std::uint32_t block) const { return map_.blocks()[block].bounds.min().x(); }

  const SurfelMap& map_;
  std::vector<std::uint32_t> order_;
  float longest_ = 0, reach_ = 0;
};

/// Whether some of these motions, T_now_before, differ around a point of now.
bool differ(const Keyframes& keyframes, const std::vector<Eigen::Isometry3d>& motions,
            const Eigen::Vector3d& center, double radius_m) {
  if (keyframes.empty()) return false;
  const Eigen::Isometry3d T_before_now = motions[keyframes.front()].inverse();
  return std::any_of(keyframes.begin() + 1, keyframes.end(), [&](std::uint32_t i) {
    const Eigen::Isometry3d T = motions[i] * T_before_now;
    return (T * center - center).norm() + angleOf(T) * radius_m > kTear_m;
  });
}

}  // namespace

std::vector<std::uint32_t> tornBlocks(const SurfelMap& before, const SurfelMap& now,
                                      const std::vector<Keyframe>& keyframes_before,
                                      const std::vector<Keyframe>& keyframes_now) {
  std::vector<Eigen::Isometry3d> motions;
  for (std::size_t i = 0; i < keyframes_now.size(); ++i) {
    motions.push_back(keyframes_now[i].T_map_camera * keyframes_before[i].T_map_camera.inverse());
  }
  const Hangers hangers(keyframes_before);
  std::vector<Keyframes> of(now.blocks().size());
  for (std::size_t i = 0; i < of.size(); ++i) of[i] = hangers.of(before.blocks()[i]);
  const BlocksAlong row(now);
  std::vector<char> is_torn(of.size(), 0);
  parallelFor(of.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfelBlock& block = now.blocks()[i];
      if (block.surfels.size() == 0) continue;
      Keyframes around;
      row.visitAround(static_cast<std::uint32_t>(i), [&](std::uint32_t other) {
        around.insert(around.end(), of[other].begin(), of[other].end());
      });
      std::sort(around.begin(), around.end());
      around.erase(std::unique(around.begin(), around.end()), around.end());
      const double radius_m = 0.5 * block.bounds.sizes().norm() + row.reach();
      is_torn[i] = differ(around, motions, block.bounds.center().cast<double>(), radius_m) ? 1 : 0;
    }
  });
  std::vector<std::uint32_t> torn;
  for (const std::uint32_t i : allBlocks(now)) {
    if (is_torn[i] != 0) torn.push_back(i);
  }
  return torn;
}

}  // namespace pf

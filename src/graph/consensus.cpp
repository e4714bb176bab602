// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/graph/consensus.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>

#include "posefusion/core/parallel.hpp"
#include "posefusion/core/symmetric.hpp"
#include "posefusion/graph/drift.hpp"

namespace pf {
namespace {

// Keyframes with another between them are of different moments.
constexpr int kApart = 1;

using Places = std::vector<std::size_t>;  // of loops in their list

class Consistency {
 public:
  Consistency(const GraphConfig& config, const std::vector<Keyframe>& keyframes,
              const std::vector<PoseConstraint>& constraints,
              const std::vector<PoseConstraint>& loops)
      : config_(config),
        keyframes_(keyframes),
        loops_(loops),
        floor_(independentCovariance(config.loop_sigma_m, config.loop_sigma_rad)),
        agree_(loops.size(), std::vector<char>(loops.size(), 0)) {
    const Ways ways(keyframes.size(), constraints);
    for (const PoseConstraint& loop : loops) {
      for (const int end : {loop.from, loop.to}) {
        const auto [found, is_new] = steps_.try_emplace(end);
        if (is_new) found->second = ways.stepsFrom(end);
      }
    }
    parallelFor(loops.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        for (std::size_t k = 0; k < loops.size(); ++k) {
          agree_[i][k] = closesCircle(loops[std::min(i, k)], loops[std::max(i, k)]) ? 1 : 0;
        }
      }
    });
  }

  /// Of some loops the most that agree with each other; those that more agree with come first.
  Places largestSet(Places of) const {
    std::vector<std::size_t> friends(loops_.size(), 0);
    for (const std::size_t i : of) {
      for (const std::size_t k : of) friends[i] += agree_[i][k] != 0 ? 1U : 0U;
    }
    std::stable_sort(of.begin(), of.end(),
                     [&](std::size_t a, std::size_t b) { return friends[a] > friends[b]; });
    Places set;
    for (const std::size_t i : of) {
      if (std::all_of(set.begin(), set.end(), [&](std::size_t k) { return agree_[i][k] != 0; })) {
        set.push_back(i);
      }
    }
    return set;
  }

  std::size_t independentOf(const Places& set) const {
    Places chosen;
    for (const std::size_t i : set) {
      const bool is_apart = std::all_of(chosen.begin(), chosen.end(), [&](std::size_t k) {
        return areApart(loops_[i].from, loops_[k].from) && areApart(loops_[i].to, loops_[k].to);
      });
      if (is_apart) chosen.push_back(i);
    }
    return chosen.size();
  }

 private:
  const Eigen::Isometry3d& pose(int keyframe) const {
    return keyframes_[static_cast<std::size_t>(keyframe)].T_map_camera;
  }

  bool areApart(int a, int b) const {
    return std::abs(a - b) >= kApart &&
           !isWithin(pose(a).inverse() * pose(b), config_.keyframe_distance_m,
                     config_.keyframe_angle_rad);
  }

  Matrix6d wayCovariance(int from, int to) const {
    const int steps = steps_.at(from)[static_cast<std::size_t>(to)];
    return driftCovariance(config_, steps, (pose(from).inverse() * pose(to)).translation().norm());
  }

  /// From camera a.from along its piece to b.from, over to b.to, and along that piece to a.to: is
  /// that where loop a leads?
  bool closesCircle(const PoseConstraint& a, const PoseConstraint& b) const {
    const Eigen::Isometry3d along_from = pose(a.from).inverse() * pose(b.from);
    const Eigen::Isometry3d along_to = pose(b.to).inverse() * pose(a.to);
    const Eigen::Isometry3d after_from = b.T_from_to * along_to;
    const Vector6d error = logSe3(a.T_from_to.inverse() * along_from * after_from);
    // Twists of what lies on the way, seen from the camera a.to.
    const Matrix6d by_from = adjoint(after_from.inverse()), by_b = adjoint(along_to.inverse());
    const Matrix6d covariance = a.covariance + floor_ + propagated(by_b, b.covariance + floor_) +
                                propagated(by_from, wayCovariance(a.from, b.from)) +
                                wayCovariance(b.to, a.to);
    return mahalanobis2(error, covariance) <= config_.max_chi_square;
  }

  const GraphConfig& config_;
  const std::vector<Keyframe>& keyframes_;
  const std::vector<PoseConstraint>& loops_;
  Matrix6d floor_;
  std::map<int, std::vector<int>> steps_;  ///< from the ends of loops to all keyframes
  std::vector<std::vector<char>> agree_;
};

}  // namespace

Consensus consensusOf(const GraphConfig& config, const std::vector<Keyframe>& keyframes,
                      const std::vector<PoseConstraint>& constraints,
                      const std::vector<PoseConstraint>& loops) {
  const Consistency consistency(config, keyframes, constraints, loops);
  Places rest(loops.size());
  std::iota(rest.begin(), rest.end(), 0);
  const Places set = consistency.largestSet(rest);
  rest.erase(std::remove_if(
                 rest.begin(), rest.end(),
                 [&](std::size_t i) { return std::find(set.begin(), set.end(), i) != set.end(); }),
             rest.end());
  Consensus consensus;
  for (const std::size_t i : set) consensus.agreeing.push_back(loops[i]);
  consensus.independent = consistency.independentOf(set);
  consensus.against = consistency.independentOf(consistency.largestSet(rest));
  return consensus;
}

}  // namespace pf

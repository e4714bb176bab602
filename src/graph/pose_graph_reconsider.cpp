// SPDX-License-Identifier: BSD-3-Clause
// Loops that hold and loops that were refused are weighed against each other.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "graph_attempt.hpp"
#include "pose_solver.hpp"

namespace pf {
namespace {

constexpr std::size_t kMostDoubted = 100;  // loops: memory, and the time to weigh them
// Graduated non-convexity: the factor from one surrogate of the truncated loss to the next, and
// where it is as good as that.
constexpr double kSharper = 2.0, kSharpest = 1e3;
// A return that counts for nothing still ties what came after it to the map.
constexpr double kLeastWeight = 1e-4;

/// Weight under the surrogate with parameter mu of the loss that is cut off at chi-square c2
/// (equation 14 of the paper).
double weightOf(double chi_square, double c2, double mu) {
  if (chi_square >= (mu + 1) / mu * c2) return kLeastWeight;
  if (chi_square <= mu / (mu + 1) * c2) return 1;
  return std::max(kLeastWeight, std::sqrt(c2 * mu * (mu + 1) / chi_square) - mu);
}

double chiSquareAt(const PoseConstraint& c, const std::vector<Eigen::Isometry3d>& poses) {
  return chiSquare(c, poses[static_cast<std::size_t>(c.from)],
                   poses[static_cast<std::size_t>(c.to)]);
}

/// What graduated non-convexity makes least: errors, those of loops cut off at chi-square c2.
double costOf(const std::vector<PoseConstraint>& all, const std::vector<Eigen::Isometry3d>& poses,
              double c2) {
  return std::accumulate(all.begin(), all.end(), 0.0, [&](double sum, const PoseConstraint& c) {
    const double error = chiSquareAt(c, poses);
    return sum + (isSwitchable(c) ? std::min(error, c2) : error);
  });
}

std::vector<Eigen::Isometry3d> posesOf(const std::vector<Keyframe>& keyframes) {
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(keyframes.size());
  for (const Keyframe& k : keyframes) poses.push_back(k.T_map_camera);
  return poses;
}

}  // namespace

bool isSwitchable(const PoseConstraint& c) {
  return c.kind == ConstraintKind::loop || c.from + 1 != c.to;
}

void PoseGraph::doubt(const PoseConstraint& loop) {
  doubted_.push_back(loop);
  if (doubted_.size() > kMostDoubted) doubted_.erase(doubted_.begin());
}

std::vector<Eigen::Isometry3d> PoseGraph::graduallySolved(const std::vector<PoseConstraint>& all,
                                                          const std::vector<char>& counts) const {
  std::vector<Eigen::Isometry3d> poses = posesOf(keyframes_);
  const std::vector<std::size_t> first = firstOfParts(keyframes_.size(), all);
  std::vector<bool> fixed(poses.size());
  for (std::size_t i = 0; i < fixed.size(); ++i) fixed[i] = first[i] == i;
  std::vector<double> weights(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) weights[i] = counts[i] != 0 ? 1 : kLeastWeight;
  const double c2 = config_.max_chi_square;
  for (double mu = 0; mu < kSharpest;) {
    if (!solvePoses(config_, all, weights, fixed, poses)) return {};
    double most = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool is_weighed = isSwitchable(all[i]) && counts[i] != 0;
      if (is_weighed) most = std::max(most, chiSquareAt(all[i], poses));
    }
    if (mu == 0 && most <= c2) break;
    mu = mu == 0 ? c2 / (2 * most - c2) : kSharper * mu;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool is_weighed = isSwitchable(all[i]) && counts[i] != 0;
      if (is_weighed) weights[i] = weightOf(chiSquareAt(all[i], poses), c2, mu);
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {  // and now all that fit
    const bool fits = !isSwitchable(all[i]) || chiSquareAt(all[i], poses) <= c2;
    weights[i] = fits ? 1 : kLeastWeight;
  }
  return solvePoses(config_, all, weights, fixed, poses) ? poses : std::vector<Eigen::Isometry3d>();
}

std::vector<Eigen::Isometry3d> PoseGraph::bestOf(const std::vector<PoseConstraint>& all) const {
  std::vector<char> everything(all.size(), 1), what_is_doubted(all.size(), 1);
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    what_is_doubted[i] = isSwitchable(all[i]) ? 0 : 1;
  }
  const double c2 = config_.max_chi_square;
  std::vector<Eigen::Isometry3d> best = posesOf(keyframes_);
  for (const auto& counts : {everything, what_is_doubted}) {
    auto poses = graduallySolved(all, counts);
    if (!poses.empty() && costOf(all, poses, c2) < costOf(all, best, c2)) best = std::move(poses);
  }
  return best;
}

GraphResult PoseGraph::reconsider() {
  GraphResult result;
  std::vector<PoseConstraint> all = constraints_;
  std::copy_if(doubted_.begin(), doubted_.end(), std::back_inserter(all),
               [this](const auto& c) { return fragmentOf(c.from) == fragmentOf(c.to); });
  result.reason = "no loop is doubted";
  if (all.size() == constraints_.size()) return result;
  const std::vector<Eigen::Isometry3d> now = posesOf(keyframes_), poses = bestOf(all);
  const auto holds = [&](const PoseConstraint& c) {
    return chiSquareAt(c, poses) <= config_.max_chi_square;
  };
  std::vector<PoseConstraint> held, doubted;
  for (const PoseConstraint& c : all) {
    (!isSwitchable(c) || holds(c) ? held : doubted).push_back(c);
  }
  result.reason = "what holds fits better";
  if (costOf(all, poses, config_.max_chi_square) >= costOf(all, now, config_.max_chi_square)) {
    return result;
  }
  if (firstOfParts(keyframes_.size(), held) != firstOfParts(keyframes_.size(), constraints_)) {
    result.reason = "a part of the map would hang on nothing";
    return result;
  }
  PoseGraph other(config_, keyframes_, held, version_);
  for (std::size_t i = 0; i < poses.size(); ++i) other.keyframes_[i].T_map_camera = poses[i];
  Attempt tried = other.attemptAll();
  result.reason = tried.reason;
  if (!result.reason.empty()) return result;
  for (const PoseConstraint& c : doubted_) {  // between fragments: these were not asked
    if (fragmentOf(c.from) != fragmentOf(c.to)) doubted.push_back(c);
  }
  for (const PoseConstraint& c : constraints_) {
    if (isSwitchable(c) && !holds(c))
      result.refused.push_back({c, "the others fit better without it"});
  }
  constraints_ = std::move(held);
  doubted_ = std::move(doubted);
  if (isWorthMoving(tried.keyframes)) {
    accept(tried, result);
  } else {
    result.reason = kConfirms;
  }
  return result;
}

}  // namespace pf

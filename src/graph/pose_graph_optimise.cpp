// SPDX-License-Identifier: BSD-3-Clause
// New loops are proved together: all constraints hold afterwards, or nothing has changed.
#include <algorithm>
#include <cstdio>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "graph_attempt.hpp"
#include "graph_checks.hpp"
#include "pose_solver.hpp"

namespace pf {
namespace {

double chiSquare(const PoseConstraint& c, const std::vector<Keyframe>& keyframes) {
  return chiSquare(c, keyframes[static_cast<std::size_t>(c.from)].T_map_camera,
                   keyframes[static_cast<std::size_t>(c.to)].T_map_camera);
}

std::string missText(const PoseConstraint& c, double chi_square, double most) {
  char text[160];
  std::snprintf(text, sizeof(text),
                "%s %d -> %d is missed by a chi-square of %.1f after optimising, expected %.1f or "
                "less",
                c.kind == ConstraintKind::loop ? "loop" : "odometry", c.from, c.to, chi_square,
                most);
  return text;
}

std::string strainText(double strain, double most) {
  char text[120];
  std::snprintf(text, sizeof(text),
                "odometry and loops would be bent by a chi-square of %.1f, expected %.1f or less",
                strain, most);
  return text;
}

}  // namespace

std::vector<std::size_t> firstOfParts(std::size_t keyframes,
                                      const std::vector<PoseConstraint>& constraints) {
  std::vector<std::size_t> first(keyframes);
  std::iota(first.begin(), first.end(), 0);
  const auto find = [&](int keyframe) {
    auto at = static_cast<std::size_t>(keyframe);
    while (first[at] != at) at = first[at] = first[first[at]];
    return at;
  };
  for (const PoseConstraint& c : constraints) {
    const std::size_t a = find(c.from), b = find(c.to);
    first[std::max(a, b)] = std::min(a, b);
  }
  for (std::size_t i = 0; i < keyframes; ++i) first[i] = find(static_cast<int>(i));
  return first;
}

PoseGraph::Attempt PoseGraph::attempt(const std::vector<Keyframe>& from,
                                      const std::vector<PoseConstraint>& loops) const {
  std::vector<PoseConstraint> all = constraints_;
  all.insert(all.end(), loops.begin(), loops.end());
  const std::vector<std::size_t> first = firstOfParts(from.size(), all);
  std::set<std::size_t> touched;
  for (const PoseConstraint& c : loops) touched.insert(first[static_cast<std::size_t>(c.from)]);
  Attempt result = solve(from, all, first, touched);
  if (result.reason.empty()) result.reason = objection(result.errors, loops.size());
  return result;
}

/// All parts of the graph, with the constraints that hold.
PoseGraph::Attempt PoseGraph::attemptAll() const {
  const std::vector<std::size_t> first = firstOfParts(keyframes_.size(), constraints_);
  Attempt result = solve(keyframes_, constraints_, first, {first.begin(), first.end()});
  for (const GraphResult::Error& e : result.errors) {
    if (result.reason.empty() && !(e.after <= config_.max_chi_square)) {
      result.reason = missText(e.constraint, e.after, config_.max_chi_square);
    }
  }
  return result;
}

/// Moves the keyframes of the connected parts named by their first keyframes.
PoseGraph::Attempt PoseGraph::solve(const std::vector<Keyframe>& from,
                                    const std::vector<PoseConstraint>& all,
                                    const std::vector<std::size_t>& first,
                                    const std::set<std::size_t>& parts) const {
  std::vector<PoseConstraint> solved;
  for (const PoseConstraint& c : all) {
    if (parts.count(first[static_cast<std::size_t>(c.from)]) > 0) solved.push_back(c);
  }
  std::vector<bool> fixed(from.size());
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < from.size(); ++i) {
    fixed[i] = first[i] == i;
    poses.push_back(from[i].T_map_camera);
  }
  Attempt result;
  result.keyframes = from;
  if (!solvePoses(config_, solved, fixed, poses)) result.reason = "the solver failed";
  for (std::size_t i = 0; i < poses.size(); ++i) result.keyframes[i].T_map_camera = poses[i];
  for (const PoseConstraint& c : all) {
    result.errors.push_back({c, chiSquare(c, keyframes_), chiSquare(c, result.keyframes)});
  }
  return result;
}

std::string PoseGraph::objection(const std::vector<GraphResult::Error>& errors,
                                 std::size_t new_loops) const {
  const double most = config_.max_chi_square;
  const auto worst = std::max_element(
      errors.begin(), errors.end(), [](const auto& a, const auto& b) { return a.after < b.after; });
  if (!(worst->after <= most)) return missText(worst->constraint, worst->after, most);
  double strain = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const bool is_new = i + new_loops >= errors.size();
    strain += errors[i].after - (is_new ? 0 : errors[i].before);
  }
  const double bearable = most * static_cast<double>(new_loops);
  return strain <= bearable ? "" : strainText(strain, bearable);
}

GraphResult PoseGraph::prove(const std::vector<Keyframe>& start,
                             std::vector<PoseConstraint> loops) {
  GraphResult result;
  result.reason = "there are no new loops";
  while (!loops.empty()) {
    Attempt tried = attempt(start, loops);
    result.reason = tried.reason;
    if (tried.reason.empty()) {
      if (isWorthMoving(tried.keyframes)) {
        accept(tried, result);
      } else {
        result.reason = kConfirms;
      }
      constraints_.insert(constraints_.end(), loops.begin(), loops.end());
      break;
    }
    const auto first_new = tried.errors.end() - static_cast<std::ptrdiff_t>(loops.size());
    const auto worst =
        std::max_element(first_new, tried.errors.end(),
                         [](const auto& a, const auto& b) { return a.after < b.after; });
    result.refused.push_back({worst->constraint, tried.reason});
    doubt(worst->constraint);
    loops.erase(loops.begin() + (worst - first_new));
  }
  return result;
}

/// Whether any keyframe would move further than any loop is off, or into another fragment.
bool PoseGraph::isWorthMoving(const std::vector<Keyframe>& corrected) const {
  for (std::size_t i = 0; i < corrected.size(); ++i) {
    if (corrected[i].fragment != keyframes_[i].fragment) return true;
    const Eigen::Isometry3d step = keyframes_[i].T_map_camera.inverse() * corrected[i].T_map_camera;
    if (!isWithin(step, config_.loop_sigma_m, config_.loop_sigma_rad)) return true;
  }
  return false;
}

void PoseGraph::accept(Attempt& attempt, GraphResult& result) {
  result.accepted = true;
  result.errors = std::move(attempt.errors);
  moveRetired(keyframes_, attempt.keyframes);
  ++version_;
  result.deformation = deformationTo(attempt.keyframes);
  keyframes_ = std::move(attempt.keyframes);
}

Deformation PoseGraph::deformationTo(const std::vector<Keyframe>& corrected) const {
  std::set<std::pair<int, int>> tracked;
  for (const PoseConstraint& c : constraints_) {
    if (c.kind == ConstraintKind::odometry) tracked.emplace(c.from, c.to);
  }
  std::vector<int> order(keyframes_.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&](int i) -> const Keyframe& { return keyframes_[static_cast<std::size_t>(i)]; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return std::tie(at(a).fragment, at(a).map_frame) < std::tie(at(b).fragment, at(b).map_frame);
  });
  std::vector<Deformation::Node> nodes;
  std::optional<Deformation::Join> join;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Keyframe& before = at(order[k]);
    const Keyframe& after = corrected[static_cast<std::size_t>(order[k])];
    Deformation::Node node;
    node.map_frame = before.map_frame;
    node.fragment = before.fragment;
    if (after.T_map_camera.matrix() != before.T_map_camera.matrix())
      node.correction = orthonormalised(after.T_map_camera * before.T_map_camera.inverse());
    node.leads_on = k + 1 < order.size() && tracked.count({order[k], order[k + 1]}) > 0;
    nodes.push_back(node);
    if (after.fragment != before.fragment) join = {before.fragment, after.fragment};
  }
  return Deformation(version_, std::move(nodes), join);
}

/// Whether the poses are where the loop wants them, as far as any loop can measure.
bool PoseGraph::isMet(const PoseConstraint& loop) const {
  const auto pose = [&](int i) { return keyframes_[static_cast<std::size_t>(i)].T_map_camera; };
  return isWithin(loop.T_from_to.inverse() * pose(loop.from).inverse() * pose(loop.to),
                  config_.loop_sigma_m, config_.loop_sigma_rad);
}

ClosedLoops PoseGraph::close(const std::vector<PoseConstraint>& loops) {
  ClosedLoops closed;
  const auto take = [&](GraphResult result) {
    closed.refused += result.refused.size();
    if (!result.accepted) return false;
    ++closed.accepted;
    closed.deformations.push_back(std::move(result.deformation));
    return true;
  };
  for (const PoseConstraint& reported : loops) {
    throwUnlessBetween(reported, keyframes_.size());
    const auto loop = inUse(reported);
    if (!loop) continue;
    if (fragmentOf(loop->from) == fragmentOf(loop->to)) {
      addLoop(*loop);
    } else if (take(joinFragment(*loop))) {
      ++closed.joined;
    }
  }
  take(optimise());
  if (closed.refused == 0) return closed;
  GraphResult weighed = reconsider();
  closed.withdrawn = weighed.refused.size();
  weighed.refused.clear();
  take(std::move(weighed));
  return closed;
}

GraphResult PoseGraph::optimise() {
  std::vector<PoseConstraint> loops = std::exchange(waiting_, {});
  const bool all_met =
      std::all_of(loops.begin(), loops.end(), [&](const auto& loop) { return isMet(loop); });
  if (loops.empty() || !all_met) return prove(keyframes_, std::move(loops));
  // Nothing to solve: on a second lap nearly every keyframe would pay for it.
  constraints_.insert(constraints_.end(), loops.begin(), loops.end());
  GraphResult result;
  result.reason = kConfirms;
  return result;
}

}  // namespace pf

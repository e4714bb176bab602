// SPDX-License-Identifier: BSD-3-Clause
// When all frames are in: every pair of keyframes that see the same surface has its say.
#include "mapper_state.hpp"
#include "posefusion/loop/dense_pairs.hpp"

namespace pf {
namespace {

LoopConstraint asLoop(const PoseConstraint& c) { return {c.from, c.to, c.T_from_to, c.covariance}; }

}  // namespace

Mapper::Refinement Mapper::refine() {
  State& s = *state_;
  Refinement result;
  if (!s.may_change || s.views.empty()) return result;
  const std::vector<MapPose> before = s.back_end.keyframePoses();
  std::vector<const KeyframeView*> views;
  for (KeyframeView& view : s.views) {
    view.pose = before[static_cast<std::size_t>(view.id)];
    views.push_back(&view);
  }
  const std::vector<PoseConstraint>& known = s.back_end.graph().constraints();
  const std::vector<PoseConstraint> pairs = densePairs(s.views, known, s.sensor);
  const auto measure = [&](const std::vector<PoseConstraint>& all) {
    result.pairs += all.size();
    auto measured = measurePairs(views, all, s.config.tracking, s.sensor);
    result.measured += measured.size();
    return measured;
  };
  const std::vector<PoseConstraint> anew = measure(known);
  std::vector<LoopConstraint> loops;
  for (const PoseConstraint& c : measure(pairs)) loops.push_back(asLoop(c));
  s.follow({s.back_end.remeasure(anew)}, before);
  s.correct(loops);
  result.largest_shift_m = largestShiftM(before, s.back_end.keyframePoses());
  return result;
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
// When all frames are in: every pair of keyframes that see the same surface has its say.
#include "mapper_state.hpp"
#include "posefusion/calibration/field_estimate.hpp"
#include "posefusion/loop/dense_pairs.hpp"

namespace pf {
namespace {

LoopConstraint asLoop(const PoseConstraint& c) { return {c.from, c.to, c.T_from_to, c.covariance}; }

}  // namespace

/// The views of the keyframes where the graph has them now.
void Mapper::State::placeViews() {
  const std::vector<MapPose> poses = back_end.keyframePoses();
  for (KeyframeView& view : views) view.pose = poses[static_cast<std::size_t>(view.id)];
}

/// Aligns all pairs; the graph, the map and all poses follow.
void Mapper::State::alignPairs(Refinement& done) {
  const std::vector<MapPose> before = back_end.keyframePoses();
  placeViews();
  std::vector<const KeyframeView*> seen;
  for (const KeyframeView& view : views) seen.push_back(&view);
  const std::vector<PoseConstraint>& known = back_end.graph().constraints();
  const std::vector<PoseConstraint> pairs = densePairs(views, known, sensor);
  const auto measure = [&](const std::vector<PoseConstraint>& all) {
    done.pairs += all.size();
    auto measured = measurePairs(seen, all, config.tracking, sensor);
    done.measured += measured.size();
    return measured;
  };
  const std::vector<PoseConstraint> anew = measure(known);
  std::vector<LoopConstraint> loops;
  for (const PoseConstraint& c : measure(pairs)) loops.push_back(asLoop(c));
  follow({back_end.remeasure(anew)}, before);
  correct(loops);
}

/// What all keyframes together tell of the depth camera; whether it was worth taking.
bool Mapper::State::learnFromAll() {
  if (!config.calibration.learns()) return false;
  placeViews();
  std::vector<CalibrationView> seen;
  for (const KeyframeView& view : views) seen.push_back(calibrationView(view, sensor));
  const FieldEstimate estimate = estimateField(seen);
  if (!(calibration ? estimate.doubtOfStep(true) : estimate.reason).empty()) return false;
  improve(estimate.asCalibration());
  return true;
}

Mapper::Refinement Mapper::refine() {
  State& s = *state_;
  Refinement result;
  if (!s.may_change || s.views.empty()) return result;
  const std::vector<MapPose> before = s.back_end.keyframePoses();
  s.alignPairs(result);
  if (s.learnFromAll()) {
    result.pairs = result.measured = 0;
    s.alignPairs(result);
  }
  result.largest_shift_m = largestShiftM(before, s.back_end.keyframePoses());
  return result;
}

}  // namespace pf

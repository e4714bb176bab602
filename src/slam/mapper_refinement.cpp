// SPDX-License-Identifier: BSD-3-Clause
// When all frames are in: every pair of keyframes that see the same surface has its say.
#include <cstdio>
#include <utility>

#include "mapper_state.hpp"
#include "posefusion/calibration/field_estimate.hpp"
#include "posefusion/loop/dense_pairs.hpp"

namespace pf {

/// The views of the keyframes where the graph has them now.
void Mapper::State::placeViews() {
  const std::vector<MapPose> poses = back_end.keyframePoses();
  for (KeyframeView& view : views) view.pose = poses[static_cast<std::size_t>(view.id)];
}

/// Aligns all pairs; the graph, the map and all poses follow.
void Mapper::State::alignPairs(Refinement& done) {
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
  wanted.remeasured = measure(known);
  std::vector<PoseConstraint> loops = measure(pairs);
  settle();
  for (PoseConstraint& loop : loops) loop.kind = ConstraintKind::loop;
  wanted.loops = std::move(loops);
  settle();
}

/// Takes in what all keyframes together reveal of the depth camera. Returns why pairs of pictures
/// would not better the map; empty: they would.
std::string Mapper::State::learnFromAll() {
  if (calibration && !config.calibration.learns()) return {};
  std::vector<CalibrationView> seen;
  for (const KeyframeView& view : views) seen.push_back(calibrationView(view, sensor));
  FieldEstimateConfig how;
  how.known = fieldOf(calibration);
  const FieldEstimate estimate = estimateField(seen, how);
  const bool is_off = estimate.doubtBeside(calibration).empty();
  if (is_off && config.calibration.learns()) {
    wanted.depth = estimate.asCalibration();
    settle();
    return {};
  }
  if (is_off) return "depth is off by a field that it is not corrected by (calibration.mode)";
  const bool is_known = calibration || estimate.clears(sensor);
  return is_known ? std::string() : "what depth is off by is not known: " + estimate.reason;
}

std::string Mapper::Refinement::text() const {
  if (!reason.empty()) return "not refined: " + reason;
  char line[128];
  std::snprintf(line, sizeof line,
                "refined: %zu pairs of keyframes compared, %zu agree; keyframes moved by up to "
                "%.1f mm",
                pairs, measured, 1000.0 * largest_shift_m);
  return line;
}

Mapper::Refinement Mapper::refine() {
  State& s = *state_;
  Refinement result;
  if (!s.may_change) result.reason = "the map may not change";
  if (s.views.empty()) result.reason = "there are no pictures of keyframes";
  if (s.views.size() == 1) result.reason = "there is one keyframe, which nothing compares with";
  if (!result.reason.empty()) return result;
  s.settle();
  const std::vector<Keyframe> before = s.back_end.graph().keyframes();
  s.placeViews();
  result.reason = s.learnFromAll();
  if (result.reason.empty()) s.alignPairs(result);
  result.largest_shift_m = largestShiftM(before, s.back_end.graph().keyframes());
  return result;
}

}  // namespace pf

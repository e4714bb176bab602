// SPDX-License-Identifier: BSD-3-Clause
// Corrections of the map are prepared beside mapping, on copies that share its blocks, and taken in
// between two frames: what did not change meanwhile is exchanged, the rest is moved then.
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "mapper_state.hpp"
#include "posefusion/map/deform.hpp"
#include "posefusion/map/layers.hpp"

namespace pf {
namespace {

// A block that no frame has touched for so long is taken to be out of view.
constexpr double kResting_s = 0.333;
// Between two corrections that do nothing but look for layers.
constexpr double kBetweenSweeps_s = 1.0;

using Places = std::vector<std::uint32_t>;  // of blocks, ascending

void sortOut(Places& places) {
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
}

Places without(const Places& places, const Places& others) {
  Places left;
  std::set_difference(places.begin(), places.end(), others.begin(), others.end(),
                      std::back_inserter(left));
  return left;
}

}  // namespace

/// The blocks of `unswept` that no frame has changed since.
std::vector<std::uint32_t> Mapper::State::restingUnswept(int since_frame) const {
  Places resting;
  std::copy_if(unswept.begin(), unswept.end(), std::back_inserter(resting),
               [&](std::uint32_t block) { return map.blocks()[block].changed < since_frame; });
  return resting;
}

/// `all`: no frame comes meanwhile, so that all that is there may be changed beside.
std::optional<MapCorrection> Mapper::State::beginCorrection(bool all) {
  --frames_to_sweep;
  if (is_correcting || !may_change || map.frame() < 0) return std::nullopt;
  const int since_frame =
      all ? std::numeric_limits<int>::max() : map.frame() - frame.pace.framesIn(kResting_s);
  Places resting = restingUnswept(since_frame);
  const bool sweeps = !resting.empty() && (all || frames_to_sweep <= 0);
  if (wanted.isEmpty() && !sweeps) return std::nullopt;
  MapCorrection correction{
      ++correction_number,     back_end.handOver(),          map.resting(since_frame),
      std::move(wanted.loops), std::move(wanted.remeasured), {},
      std::move(resting)};
  if (wanted.depth) correction.depth = improvementBy(*wanted.depth);
  wanted = {};
  is_correcting = true;
  frames_to_sweep = frame.pace.framesIn(kBetweenSweeps_s);
  return correction;
}

void Mapper::State::finishCorrection(CorrectedMap& corrected) {
  if (!is_correcting || corrected.number != correction_number) return;  // of a map that is gone
  is_correcting = false;
  if (!may_change) return;
  auto deformations = back_end.takeUp(std::move(corrected.graph), corrected.closed);
  const Places changed = map.takeUp(corrected.before, corrected.map);
  sortOut(corrected.swept);
  unswept = without(unswept, without(corrected.swept, changed));
  std::optional<Deformation> by_depth;
  if (corrected.depth && corrected.depth->moves_keyframes) {
    by_depth = std::move(deformations.back());
    deformations.pop_back();
  }
  follow(deformations, changed, corrected.lays_layers);
  if (corrected.depth) finishDepth(*corrected.depth, by_depth, changed);
  if (by_depth && corrected.lays_layers) mayBeDouble(changed);
  retireViews(corrected.retired);
  for (const auto& [step, version] : std::exchange(wanted_steps, {})) retrack(step, version);
}

/// The depth of all that is known is corrected, and from the next frame on that of frames.
/// `motion`: of the keyframes.
void Mapper::State::finishDepth(DepthImprovement& depth, const std::optional<Deformation>& motion,
                                const std::vector<std::uint32_t>& changed) {
  depth.step.keyframes = back_end.graph().keyframes();
  if (motion) depth.step.motion = *motion;
  correctDepth(map, depth.step, changed);
  if (motion) follow({*motion}, {}, false);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i < depth.views.size()) {
      std::swap(views[i].depth_mm, depth.views[i].depth_mm);
    } else {
      pf::correctDepth(depth.of_views, views[i]);
    }
  }
  noteImproved(depth);
  depthHasChanged(depth.of_frames);
}

/// Drops the pictures of keyframes that others represent.
void Mapper::State::retireViews(const std::vector<int>& ids) {
  const auto isRetired = [&](const KeyframeView& view) {
    return std::binary_search(ids.begin(), ids.end(), static_cast<int>(view.id));
  };
  views.erase(std::remove_if(views.begin(), views.end(), isRetired), views.end());
  retired.insert(retired.end(), ids.begin(), ids.end());
  std::sort(retired.begin(), retired.end());
}

/// A step of tracking as its pictures have it: what hangs on it is what was seen last.
void Mapper::State::retrack(const PoseConstraint& step, int version) {
  // Of depth as it was before, pictures say something else.
  if (!may_change || version != depth_version) return;
  if (is_correcting) {
    wanted_steps.emplace_back(step, version);
    return;
  }
  const std::vector<Keyframe> before = back_end.graph().keyframes();
  const Deformation deformation = back_end.retrack(step);
  const double shift_m = largestShiftM(before, back_end.graph().keyframes());
  follow({deformation}, allBlocks(map), shift_m > kLeastLayer_m);
}

/// Layers are to be looked for in those of the blocks that were moved just now.
void Mapper::State::mayBeDouble(const std::vector<std::uint32_t>& blocks) {
  std::copy_if(blocks.begin(), blocks.end(), std::back_inserter(unswept),
               [&](std::uint32_t block) { return map.blocks()[block].changed == map.frame(); });
  sortOut(unswept);
}

/// `blocks`: that are still to be moved.
void Mapper::State::follow(const std::vector<Deformation>& deformations,
                           const std::vector<std::uint32_t>& blocks, bool lays_layers) {
  int where = fragment();
  Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();
  bool moves = false;
  for (const Deformation& deformation : deformations) {
    if (deformation.isIdentity()) continue;
    moves = true;
    T_new_old = deformation.at(map.frame(), where) * T_new_old;
    where = deformation.fragmentAfter(where);
    deform(map, deformation, blocks);
    fuser.follow(deformation);
  }
  if (!moves) return;
  if (lays_layers) mayBeDouble(blocks);
  if (isPlaceKnown()) reckoning.correct(T_new_old);
  localiser.move(T_new_old, where);
  T_map_uncorrected = orthonormalised(T_new_old * T_map_uncorrected);
  moveView(where, T_new_old);
  keyframes_moved = true;
  map_at_loss.reset();
  seen_at.reset();
  place_is_stale = true;
}

/// What the last frame was fused into looks as before from where the camera is now said to be.
void Mapper::State::moveView(int fragment, const Eigen::Isometry3d& T_new_old) {
  if (wanted_view) {
    wanted_view->pose = {fragment, T_new_old * wanted_view->pose.T_map_camera};
    return;
  }
  const MapPose pose{fragment, T_new_old * view.T_map_camera};
  if (view.stamp_ns != last_stamp_ns) return showFrom(pose, view.stamp_ns, false);
  view.T_map_camera = seen.T_map_camera = pose.T_map_camera;
  view.T_map_uncorrected = seen.T_map_uncorrected = T_map_uncorrected;
  view.fragment = seen.fragment = fragment;
}

std::optional<MapCorrection> Mapper::takeCorrection() { return state_->beginCorrection(false); }

void Mapper::take(CorrectedMap& corrected) { state_->finishCorrection(corrected); }

void Mapper::abandonCorrection() {
  state_->is_correcting = false;
  state_->wanted_steps.clear();
}

void Mapper::State::settle() {
  is_correcting = false;  // what is still prepared elsewhere comes too late
  while (auto correction = beginCorrection(true)) {
    CorrectedMap corrected = prepare(std::move(*correction));
    finishCorrection(corrected);
  }
}

void Mapper::settle() { state_->settle(); }

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/map_append.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <utility>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

/// Where the numbers of a map begin.
struct FirstNumbers {
  int frame, keyframe, fragment;
};

int lastFragment(const SavedMap& map) {
  int last = kFirstFragment;
  for (const Keyframe& k : map.keyframes) last = std::max(last, k.fragment);
  for (const FragmentSurfels& part : map.surfels) last = std::max(last, part.fragment);
  return last;
}

/// After the last of one map, so that the other has room behind it.
int next(int last, int last_of_other, const char* what) {
  const std::int64_t all = std::int64_t{last} + 1 + last_of_other;
  if (all < std::numeric_limits<std::int32_t>::max()) return last + 1;
  throw InputError("both together have more " + std::string(what) + " than can be counted");
}

void renumber(SavedMap& map, const FirstNumbers& first) {
  for (FragmentSurfels& part : map.surfels) {
    part.fragment += first.fragment;
    for (auto* numbers : {&part.surfels.created, &part.surfels.seen}) {
      for (std::int32_t& frame : *numbers) frame += first.frame;
    }
  }
  for (Keyframe& keyframe : map.keyframes) {
    keyframe.id += first.keyframe;
    keyframe.fragment += first.fragment;
    keyframe.map_frame += first.frame;
    if (keyframe.isRetired()) keyframe.follows += first.keyframe;
  }
  for (PoseConstraint& constraint : map.constraints) {
    constraint.from += first.keyframe;
    constraint.to += first.keyframe;
  }
  for (FrameRecord& frame : map.frames) frame.pose.keyframe += first.keyframe;
  for (KeyframeView& view : map.views) {
    view.id += first.keyframe;
    view.pose.fragment += first.fragment;
  }
}

template <typename Row>
void append(std::vector<Row>& rows, std::vector<Row>& more) {
  std::move(more.begin(), more.end(), std::back_inserter(rows));
}

}  // namespace

std::optional<DepthCalibration> betterKnown(const SavedMap& a, const SavedMap& b) {
  if (!a.calibration || !b.calibration) return a.calibration ? a.calibration : b.calibration;
  return b.calibration->pairs > a.calibration->pairs ? b.calibration : a.calibration;
}

SavedMap appended(SavedMap first, SavedMap second) {
  const FirstNumbers numbers = {next(first.frame, second.frame, "frames"),
                                static_cast<int>(first.keyframes.size()),
                                next(lastFragment(first), lastFragment(second), "fragments")};
  renumber(second, numbers);
  SavedMap both = std::move(first);
  append(both.surfels, second.surfels);
  append(both.keyframes, second.keyframes);
  append(both.constraints, second.constraints);
  append(both.frames, second.frames);
  append(both.views, second.views);
  both.frame = numbers.frame + second.frame;
  both.graph_version += second.graph_version;
  both.brightness = second.brightness;  // of the last frame, whose keyframe is the last one
  both.calibration = betterKnown(both, second);
  return both;
}

}  // namespace pf

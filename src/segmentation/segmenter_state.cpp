// SPDX-License-Identifier: BSD-3-Clause
#include "segmenter_state.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "posefusion/segmentation/location.hpp"
#include "posefusion/segmentation/upsample.hpp"

namespace pf {
namespace {

constexpr double kMinDepth_m = 0.25;
constexpr float kUnlabelledFading =
    0.6F;  // at 30 Hz, of the likelihood of joints outside the mask ...
constexpr float kFadedLikelihood = 0.08F;  // ... until they are dropped

// How much each frame (at 30 Hz) without a detection ages a carried person.
constexpr double kAgeing = 1.0;
constexpr double kConfirmedAgeing = 0.25;  // the map confirms a person in front of it
constexpr double kBlindAgeing = 3.0;       // no map: the mask may leak into furniture unnoticed

constexpr double kMarginWidth_px = 640.0;  // image width that margin_px is given for

/// Carried joints that the mask does not hold have lost their person: they fade, then go.
void fadeLostJoints(const SceneGrid& grid, const std::vector<std::uint8_t>& labels, float worth,
                    Person& person) {
  const float fading = std::pow(kUnlabelledFading, worth);
  for (Keypoint& joint : person.joints) {
    const int cell = joint.p > 0.0F ? grid.cellAt(joint.u, joint.v) : -1;
    if (cell < 0 || labels[cell] != 0) continue;
    joint.p *= fading;
    if (joint.p < kFadedLikelihood) joint.p = 0.0F;
  }
}

}  // namespace

/// Samples the frame. The cells of carried people count on the grid of the last frame: where this
/// one has another size, they mean nothing and the people are forgotten.
void PeopleSegmenter::State::takeGrid(const RgbdFrame& frame, int grid_width) {
  const auto sizeOf = [](const SceneGrid& g) { return std::make_tuple(g.cols, g.rows, g.step); };
  const auto last = sizeOf(evidence.grid);
  depthInMetres(frame, kMinDepth_m, kFarthestPerson_m, depth_m);
  sampleGrid(frame, depth_m, grid_width, evidence.grid);
  if (sizeOf(evidence.grid) != last) people.clear();
}

void PeopleSegmenter::State::locate(double carry_s) {
  std::vector<TrackedPerson> located;
  for (TrackedPerson& tracked : people) {
    if (!locatePerson(evidence, carry_s, tracked)) continue;
    if (tracked.id == 0) tracked.id = ++last_id;
    tracked.person.id = tracked.id;
    located.push_back(std::move(tracked));
  }
  people.swap(located);
}

void PeopleSegmenter::State::markCarriedMasks() {
  const SceneGrid& grid = evidence.grid;
  evidence.carried.assign(grid.size(), -1);
  for (std::size_t i = 0; i < people.size(); ++i) {
    for (int cell : people[i].cells) {
      const float gap_m = std::abs(grid.z[cell] - people[i].depth_m);
      if (grid.hasDepth(cell) && gap_m > kMaxMaskSpread_m) continue;
      evidence.carried[cell] = static_cast<std::int16_t>(i);
    }
  }
}

void PeopleSegmenter::State::markShownPeople() {
  evidence.shown_person.assign(evidence.grid.size(), -1);
  if (evidence.shown.empty()) return;
  std::vector<std::int16_t> of_detection(people.size(), -1);
  for (std::size_t i = 0; i < people.size(); ++i) {
    const auto detection = static_cast<std::size_t>(std::max(0, people[i].detection));
    if (detection >= of_detection.size()) of_detection.resize(detection + 1, -1);
    if (people[i].detection >= 0) of_detection[detection] = static_cast<std::int16_t>(i);
  }
  for (int cell = 0; cell < evidence.grid.size(); ++cell) {
    const int detection = evidence.shown.detection[cell];
    if (detection < 0 || detection >= static_cast<int>(of_detection.size())) continue;
    evidence.shown_person[cell] = of_detection[static_cast<std::size_t>(detection)];
  }
}

void PeopleSegmenter::State::cut(const SegmentationConfig& config) {
  markCarriedMasks();
  markShownPeople();
  measureDistance(people, evidence.grid, kDistanceLimit, evidence.distance);
  improvedUnary(evidence, config, people, unary);
  cutter.cut(evidence.grid, unary, config, labels);
  keepAnchoredRegions(evidence.grid, people, labels);
}

/// Hands the mask's cells to the people for the next frame; people without a mask go.
void PeopleSegmenter::State::keepPeople(bool with_map) {
  for (TrackedPerson& tracked : people) tracked.cells.clear();
  for (int cell = 0; cell < evidence.grid.size(); ++cell) {
    if (labels[cell] == 0) continue;
    const int owner = candidateOf(evidence, cell);
    if (owner >= 0) people[owner].cells.push_back(cell);
  }
  for (TrackedPerson& tracked : people) {
    const bool confirmed = standsBeforeMap(tracked.cells, evidence.background);
    const bool blind = !with_map && !tracked.fresh;
    tracked.unseen += worth * (confirmed ? kConfirmedAgeing : blind ? kBlindAgeing : kAgeing);
    fadeLostJoints(evidence.grid, labels, worth, tracked.person);
  }
  const auto isTooSmall = [](const TrackedPerson& t) { return t.cells.size() < kMinMaskCells; };
  people.erase(std::remove_if(people.begin(), people.end(), isTooSmall), people.end());
}

/// Takes these cells out of the depth, at full resolution.
void PeopleSegmenter::State::takeOut(const RgbdFrame& frame, const std::vector<std::uint8_t>& taken,
                                     int margin_px, Segmentation& result) const {
  result.mask = upsampleMask(frame, depth_m, evidence.grid, taken);
  const double margin = margin_px * frame.depth.cols / kMarginWidth_px;
  result.static_depth =
      removeMasked(frame.depth, result.mask, static_cast<int>(std::lround(margin)));
}

}  // namespace pf

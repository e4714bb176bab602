// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/location.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "posefusion/core/pace.hpp"
#include "posefusion/segmentation/mapped_people.hpp"

namespace pf {
namespace {

constexpr float kMaxShownSpread_m = 0.5F;  // in depth, of the detector's mask around its person

// A new person, found by a detector that gives a mask with every frame.
constexpr float kSureNewScore = 0.65F;  // believed without the map
constexpr float kShownNew = 0.5F;       // least probability of the cells considered
// Of those that the map knows, this part lies in front of it: the others may be on what was mapped
// of them while they came in, which it has seen for a few frames only. Furniture that looks like
// people agrees with it, and nowhere lies in front of it.
constexpr float kNearerNew = 0.15F;
constexpr float kMostAgreeingNew = 0.5F;

// A person in front of the map.
constexpr float kKnownBefore = 0.5F;   // it knows this part of the cells ...
constexpr float kNearerBefore = 0.7F;  // ... of which this part lies in front of it

// A person that is part of the map by mistake.
constexpr double kInMap_s = 1.0 / 3.0;  // for so long after a sure detection
constexpr float kMinKnownSeeds = 3.0F;  // seeds where the map is known, of which ...
constexpr float kInMapPart = 0.6F;      // ... this part agrees, for a person to be in the map

/// Cells of the carried mask, at the person's depth, that lie in front of the known background.
std::vector<int> cellsBeforeMap(const Evidence& evidence, const TrackedPerson& tracked) {
  std::vector<int> cells;
  for (int cell : tracked.cells) {
    if (evidence.background[cell] == Background::nearer &&
        std::abs(evidence.grid.z[cell] - tracked.depth_m) < kMaxMaskSpread_m) {
      cells.push_back(cell);
    }
  }
  return cells;
}

/// Median depth of cells that have depth, 0 if there are none.
float medianDepthOf(const std::vector<int>& cells, const SceneGrid& grid) {
  std::vector<float> depths;
  for (int cell : cells) depths.push_back(grid.z[cell]);
  if (depths.empty()) return 0.0F;
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  return depths[depths.size() / 2];
}

/// Cells that the detector's mask shows, without those that lie on something behind or in front.
std::vector<int> shownCells(const std::vector<int>& sure, float depth_m, const SceneGrid& grid) {
  std::vector<int> cells;
  for (int cell : sure) {
    if (std::abs(grid.z[cell] - depth_m) < kMaxShownSpread_m) cells.push_back(cell);
  }
  return cells;
}

/// Removes the cells of which the condition holds.
template <typename Condition>
void dropCells(const Condition& condition, std::vector<int>& cells) {
  cells.erase(std::remove_if(cells.begin(), cells.end(), condition), cells.end());
}

/// The person's body by the joints and the detector's mask, without seeds on what hides the person.
void liftDetected(const Evidence& evidence, TrackedPerson& tracked) {
  const std::vector<int> sure = evidence.shown.sureCells(tracked.detection, evidence.grid);
  const float shown_depth_m = medianDepthOf(sure, evidence.grid);
  tracked.body =
      liftPerson(tracked.person, evidence.grid, tracked.fresh ? shown_depth_m : tracked.depth_m);
  Body& body = tracked.body;
  if (body.depth_m <= 0.0F) body.depth_m = shown_depth_m;
  body.shown = shownCells(sure, shown_depth_m, evidence.grid);
  const bool is_shown = !body.shown.empty();
  const auto hides = [&](int cell) {
    return evidence.flatness[cell] == Flatness::small ||
           (is_shown && isDenied(evidence.shown, cell));
  };
  dropCells(hides, body.seeds);
  dropCells(hides, body.shown);
}

bool isKnown(const MapVote& vote, const std::vector<int>& cells) {
  return vote.known > kKnownBefore * static_cast<float>(cells.size());
}

/// Whether something has come where the map knew another surface.
bool cameBeforeMap(const std::vector<int>& cells, const std::vector<Background>& background) {
  const MapVote vote = voteOf(cells, background);
  return cells.size() >= kMinMaskCells && isKnown(vote, cells) &&
         vote.nearer > kNearerNew * vote.known && vote.agrees < kMostAgreeingNew * vote.known;
}

}  // namespace

MapVote voteOf(const std::vector<int>& cells, const std::vector<Background>& background) {
  MapVote vote;
  for (int cell : cells) {
    vote.known += background[cell] != Background::unknown;
    vote.agrees += background[cell] == Background::agrees;
    vote.nearer += background[cell] == Background::nearer;
  }
  return vote;
}

std::vector<bool> mayBeNew(const People& detected, const ShownPeople& shown,
                           const std::vector<Background>& background) {
  std::vector<std::vector<int>> cells(detected.people.size());
  std::vector<bool> in_mask(detected.people.size(), false);
  for (std::size_t cell = 0; cell < shown.detection.size(); ++cell) {
    const auto index = static_cast<std::size_t>(shown.detection[cell]);
    if (shown.detection[cell] < 0 || index >= cells.size()) continue;
    in_mask[index] = true;
    if (shown.probability[cell] >= kShownNew) cells[index].push_back(static_cast<int>(cell));
  }
  std::vector<bool> may_be_new;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    may_be_new.push_back(!in_mask[i] || detected.people[i].score >= kSureNewScore ||
                         cameBeforeMap(cells[i], background));
  }
  return may_be_new;
}

bool standsBeforeMap(const std::vector<int>& cells, const std::vector<Background>& background) {
  const MapVote vote = voteOf(cells, background);
  return isKnown(vote, cells) && vote.nearer > kNearerBefore * vote.known;
}

bool locatePerson(const Evidence& evidence, double carry_s, TrackedPerson& tracked) {
  liftDetected(evidence, tracked);
  Body& body = tracked.body;
  MapVote vote = voteOf(body.seeds, evidence.background);
  vote += voteOf(body.shown, evidence.background);
  const bool in_map = vote.known >= kMinKnownSeeds && vote.agrees > kInMapPart * vote.known;
  if (in_map && tracked.fresh && standsBeforeMap(tracked.cells, evidence.background)) {
    // A detection on the wall beside: the carried mask knows better where the person is.
    body = Body();
    tracked.fresh = false;
    tracked.detection = -1;
  }
  if (tracked.fresh) tracked.in_map = in_map && isSure(tracked.person);
  if (tracked.unseen > Pace::kUsual_hz * kInMap_s) tracked.in_map = false;
  if (in_map && tracked.fresh && !tracked.in_map) return false;
  if (!tracked.in_map) {
    const auto agrees = [&](int cell) { return evidence.background[cell] == Background::agrees; };
    dropCells(agrees, body.seeds);
    dropCells(agrees, body.shown);
  }
  body.anchors = cellsBeforeMap(evidence, tracked);
  if (tracked.unseen > Pace::kUsual_hz * carry_s) return false;
  body.anchors.insert(body.anchors.end(), body.shown.begin(), body.shown.end());
  if (body.seeds.empty() && body.anchors.size() < kMinMaskCells) return false;
  if (body.depth_m <= 0.0F) body.depth_m = tracked.depth_m;
  body.anchors.insert(body.anchors.end(), body.seeds.begin(), body.seeds.end());
  tracked.depth_m = body.depth_m;
  return true;
}

}  // namespace pf

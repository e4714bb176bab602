// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/energy.hpp"

#include <algorithm>
#include <array>

#include "posefusion/core/parallel.hpp"
#include "posefusion/segmentation/mapped_people.hpp"

namespace pf {
namespace {

// Distances to a skeleton, in capsule radii.
constexpr float kInside = 1.0F;           // nearer: surely the person's colours
constexpr float kOutside = 2.5F;          // farther: surely not
constexpr float kFarthestInFront = 2.5F;  // a cell before the map counts as no farther than this
constexpr float kFarthestShown = 1.5F;    // and one that the detector's mask shows, than this

// Colour: the logarithm of a ratio of likelihoods, and how histograms are learnt.
constexpr float kColorLimit = 3.0F;
constexpr float kColorMemory = 0.3F;       // part of a newer histogram that is taken over
constexpr float kMinColorSamples = 20.0F;  // cells

// What the map says, in units of `model_weight`.
constexpr float kNearerThanMap = 1.0F;
constexpr float kRecentInMap = -0.5F;
constexpr float kFartherThanMap = -1.5F;
constexpr float kAgreesWithMap = -2.0F;

// Further terms, in units of the distance term.
constexpr float kOnPlane = -3.0F;
constexpr float kNoPerson = -4.0F;       // instead of all others: on a small plane, another thing
constexpr float kCarriedInFront = 1.5F;  // in the carried mask and before the map
constexpr float kCarried = 0.7F;         // in the carried mask, the map unknown
constexpr float kHoleFactor = 0.5F;      // missing depth counts less ...
constexpr float kHoleBias = -1.5F;       // ... and is most often shadow beside a person

/// Whether the last skeleton or the detector's mask shows a person in the cell.
bool isDetected(const Evidence& evidence, int cell) {
  return evidence.distance.relative[cell] < kInside ||
         (evidence.shown_person[cell] >= 0 && isShown(evidence.shown, cell));
}

/// Whether the cell shows something else than a person: another moving object was followed there,
/// or the detector's mask denies what has stood there for a second.
bool isOtherThing(const Evidence& evidence, int cell) {
  if (isDetected(evidence, cell)) return false;
  return evidence.object[cell] >= 0 ||
         (evidence.stood[cell] != 0 && isDenied(evidence.shown, cell));
}

/// What the map says of a cell, unless its candidate is known to be in the map by mistake.
Background backgroundOf(const Evidence& evidence, const std::vector<TrackedPerson>& people,
                        int cell) {
  const Background background = evidence.background[cell];
  const int candidate = candidateOf(evidence, cell);
  if (candidate < 0) return background;
  const bool in_map = background == Background::agrees && people[candidate].in_map;
  if (in_map || isMappedPerson(evidence, people, cell)) return Background::unknown;
  return background;
}

/// Updates the colours of every person and returns those of what is around them.
ColorHistogram learnColors(const Evidence& evidence, const std::vector<int>& bins,
                           std::vector<TrackedPerson>& people) {
  ColorHistogram outside;
  std::vector<ColorHistogram> inside(people.size());
  for (int cell = 0; cell < evidence.grid.size(); ++cell) {
    const float distance = evidence.distance.relative[cell];
    const Background background = backgroundOf(evidence, people, cell);
    const int candidate = candidateOf(evidence, cell);
    const bool carried = evidence.carried[cell] >= 0;
    const bool shown = evidence.shown_person[cell] >= 0 && isShown(evidence.shown, cell);
    if (background == Background::agrees || background == Background::farther ||
        isFlat(evidence, cell) || (distance > kOutside && !carried && !shown)) {
      outside.add(bins[cell]);
    } else if (candidate >= 0 && evidence.grid.hasDepth(cell) &&
               (distance < kInside || shown || (carried && background == Background::nearer))) {
      inside[candidate].add(bins[cell]);
    }
  }
  outside.smoothAndNormalise();
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (inside[i].total() < kMinColorSamples) continue;
    inside[i].smoothAndNormalise();
    people[i].color.blend(inside[i], kColorMemory);
  }
  return outside;
}

/// What each colour says of being each person's.
using ColorTerms = std::array<float, ColorHistogram::kBins>;
std::vector<ColorTerms> colorTerms(const std::vector<TrackedPerson>& people,
                                   const ColorHistogram& outside) {
  std::vector<ColorTerms> terms(people.size());
  for (std::size_t i = 0; i < people.size(); ++i) {
    for (int bin = 0; bin < ColorHistogram::kBins; ++bin) {
      terms[i][bin] = logLikelihoodRatio(people[i].color, outside, bin, kColorLimit);
    }
  }
  return terms;
}

float modelTerm(Background background) {
  switch (background) {
    case Background::agrees:
      return kAgreesWithMap;
    case Background::recent:
      return kRecentInMap;
    case Background::farther:
      return kFartherThanMap;
    case Background::nearer:
      return kNearerThanMap;
    default:
      return 0.0F;
  }
}

}  // namespace

int candidateOf(const Evidence& evidence, int cell) {
  if (evidence.shown_person[cell] >= 0) return evidence.shown_person[cell];
  const int owner = evidence.distance.owner[cell];
  return owner >= 0 ? owner : evidence.carried[cell];
}

bool isFlat(const Evidence& evidence, int cell) {
  const Flatness flatness = evidence.flatness[cell];
  if (flatness == Flatness::small) return true;
  return flatness == Flatness::large && evidence.background[cell] != Background::nearer;
}

void improvedUnary(const Evidence& evidence, const SegmentationConfig& config,
                   std::vector<TrackedPerson>& people, Unary& unary) {
  const SceneGrid& grid = evidence.grid;
  const float color_weight = static_cast<float>(config.color_weight);
  const float model_weight = static_cast<float>(config.model_weight);
  const float mask_weight = static_cast<float>(config.mask_weight);
  std::vector<int> bins(grid.size());
  for (int cell = 0; cell < grid.size(); ++cell) {
    bins[cell] =
        ColorHistogram::binOf(grid.color.at<cv::Vec3b>(cell / grid.cols, cell % grid.cols));
  }
  const ColorHistogram outside = learnColors(evidence, bins, people);
  const std::vector<ColorTerms> colors = colorTerms(people, outside);
  unary.assign(grid.size(), -kCertain);
  const auto termsOf = [&](int cell) {
    const int candidate = candidateOf(evidence, cell);
    const Background background = backgroundOf(evidence, people, cell);
    const bool in_front = background == Background::nearer;
    if (candidate < 0 && !in_front) return -kCertain;
    // Far from the skeleton only what stands before the map can be a person: an unseen leg.
    const float farthest = evidence.shown_person[cell] >= 0 ? kFarthestShown
                           : in_front                       ? kFarthestInFront
                                                            : kDistanceLimit;
    float value = 1.0F - std::min(evidence.distance.relative[cell], farthest);
    if (candidate >= 0) value += color_weight * colors[candidate][bins[cell]];
    value += model_weight * modelTerm(background);
    const bool is_shown = candidate >= 0 && !people[candidate].body.shown.empty();
    value += mask_weight * shownTerm(evidence.shown, cell, is_shown);
    if (isFlat(evidence, cell)) value += kOnPlane;
    if (evidence.carried[cell] >= 0 && background != Background::agrees) {
      value += in_front ? kCarriedInFront : kCarried;
    }
    if (evidence.flatness[cell] == Flatness::small || isOtherThing(evidence, cell)) {
      value = kNoPerson;
    }
    if (!grid.hasDepth(cell)) value = kHoleFactor * value + kHoleBias;
    return value;
  };
  parallelFor(unary.size(), kCellsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      unary[cell] = termsOf(static_cast<int>(cell));
    }
  });
  for (const TrackedPerson& tracked : people) {
    for (int seed : tracked.body.seeds) unary[seed] = kCertain;
  }
}

}  // namespace pf

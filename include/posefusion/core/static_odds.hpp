// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace pf {

/// The belief that a surfel stands still, as log-odds (nats) of "stands still" against "moves, or
/// is no surface". Views raise and lower it by what they say; 0 is not known. After the clamped
/// log-odds of occupancy mapping (Moravec and Elfes 1985; OctoMap, Hornung et al. 2013).
///
/// Views of one second are partly the same: a frame counts for the time that it represents
/// (`frames`: at 30 Hz, see Pace::worth()), so that a second is worth the same at any rate.
namespace static_odds {

/// Evidence of a frame at 30 Hz, for or against: a second of them makes 1 : 80 of 1 : 1.
constexpr float kFrame = 4.4F / 30.0F;

/// However often a thing was seen, it may be moved: 0.5 s of views that see through it, each of
/// which counts twice, are enough to remove it.
constexpr float kMost = 24.0F * kFrame;

/// What lies in front of a known surface, or in space that was seen free, has come there, perhaps a
/// person that the detector misses: it takes a second longer to count as part of the room.
constexpr float kNewcomer = -30.0F * kFrame;

/// Contradicted to below this (0.29) it is no longer kept: what remains may be mapped anew.
constexpr float kRefuted = -6.0F * kFrame;

/// Of what was refuted: never comes back.
constexpr float kGone = -100.0F;

/// Log-odds of a probability within [0, 1]; minus infinity of 0.
inline float of(double probability) {
  return static_cast<float>(std::log(probability) - std::log1p(-probability));
}

inline float probability(float odds) { return 1.0F / (1.0F + std::exp(-odds)); }

/// After views worth `frames` that agree.
inline float supported(float odds, float frames) { return std::min(kMost, odds + frames * kFrame); }

/// After views worth `frames` that contradict.
inline float contradicted(float odds, float frames) {
  const float left = odds - frames * kFrame;
  return left < kRefuted ? kGone : left;
}

}  // namespace static_odds
}  // namespace pf

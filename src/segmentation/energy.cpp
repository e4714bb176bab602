// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/energy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pf {
namespace {

constexpr float kColourLimit = 3.0F;
constexpr float kColourMemory = 0.3F;  // part of a newer histogram taken over
constexpr float kInside = 1.0F;        // relative distance: surely a person's colours
constexpr float kOutside = 2.5F;       // surely not

/// The track that a cell could belong to, -1: none.
int candidateOf(const Evidence& evidence, int cell) {
  const int owner = evidence.distance.owner[cell];
  return owner >= 0 ? owner : evidence.prior[cell];
}

/// The map's word on a cell, unless its candidate is known to be in the map by mistake.
Background backgroundOf(const Evidence& evidence, const std::vector<PersonTrack>& tracks,
                        int cell) {
  const Background background = evidence.background[cell];
  const int candidate = candidateOf(evidence, cell);
  if (candidate < 0) return background;
  const bool in_map = background == Background::agrees && tracks[candidate].in_map;
  // Next to a joint that was seen just now, the skeleton knows better than a young surface.
  const bool too_young = background == Background::recent && tracks[candidate].fresh &&
                         evidence.distance.relative[cell] < kInside;
  if (in_map || too_young) return Background::unknown;
  return background;
}

bool isFlat(const Evidence& evidence, int cell) {
  return evidence.on_plane[cell] != 0 && evidence.background[cell] != Background::nearer;
}

/// Colours of every person and of what is around them.
ColourHistogram learnColours(const SceneGrid& grid, const Evidence& evidence,
                             const std::vector<int>& bins, std::vector<PersonTrack>& tracks) {
  ColourHistogram outside;
  std::vector<ColourHistogram> inside(tracks.size());
  for (int cell = 0; cell < grid.size(); ++cell) {
    const float distance = evidence.distance.relative[cell];
    const Background background = backgroundOf(evidence, tracks, cell);
    const int candidate = candidateOf(evidence, cell);
    const bool in_prior = evidence.prior[cell] >= 0;
    if (background == Background::agrees || background == Background::farther ||
        isFlat(evidence, cell) || (distance > kOutside && !in_prior)) {
      outside.add(bins[cell]);
    } else if (candidate >= 0 && grid.hasDepth(cell) &&
               (distance < kInside || (in_prior && background == Background::nearer))) {
      inside[candidate].add(bins[cell]);
    }
  }
  outside.smoothAndNormalise();
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (inside[t].total() < 20.0F) continue;
    inside[t].smoothAndNormalise();
    tracks[t].colour.blend(inside[t], kColourMemory);
  }
  return outside;
}

float modelTerm(Background background, float weight) {
  switch (background) {
    case Background::agrees:
      return -2.0F * weight;
    case Background::recent:
      return -0.5F * weight;
    case Background::farther:
      return -1.5F * weight;
    case Background::nearer:
      return weight;
    default:
      return 0.0F;
  }
}

constexpr float kHoleBias = 1.5F;  // missing depth is most often shadow beside a person

}  // namespace

void improvedUnary(const SceneGrid& grid, const Evidence& evidence, const std::vector<Body>& bodies,
                   const SegmentationConfig& config, std::vector<PersonTrack>& tracks,
                   Unary& unary) {
  std::vector<int> bins(grid.size());
  for (int cell = 0; cell < grid.size(); ++cell) {
    bins[cell] =
        ColourHistogram::binOf(grid.color.at<cv::Vec3b>(cell / grid.cols, cell % grid.cols));
  }
  const ColourHistogram outside = learnColours(grid, evidence, bins, tracks);
  unary.assign(grid.size(), -kCertain);
  for (int cell = 0; cell < grid.size(); ++cell) {
    const int candidate = candidateOf(evidence, cell);
    const Background background = backgroundOf(evidence, tracks, cell);
    if (candidate < 0 && background != Background::nearer) continue;
    const bool in_front = background == Background::nearer;
    const bool in_prior = evidence.prior[cell] >= 0;
    // Far from the skeleton only what stands before the map can be a person: an unseen leg.
    const float distance = std::min(evidence.distance.relative[cell], in_front ? 2.5F : 4.0F);
    float value = 1.0F - distance;
    if (candidate >= 0) {
      value += static_cast<float>(config.colour_weight) *
               logLikelihoodRatio(tracks[candidate].colour, outside, bins[cell], kColourLimit);
    }
    value += modelTerm(background, static_cast<float>(config.model_weight));
    if (isFlat(evidence, cell)) value -= 3.0F;
    if (in_prior && background != Background::agrees) value += in_front ? 1.5F : 0.7F;
    if (!grid.hasDepth(cell)) value = 0.5F * value - kHoleBias;
    unary[cell] = value;
  }
  for (const Body& body : bodies) {
    for (int seed : body.seeds) unary[seed] = kCertain;
  }
}

float paperUnary(const Eigen::Vector3f& point, const std::vector<Eigen::Vector3f>& seeds,
                 const Eigen::Vector3f& up, float radius_m) {
  constexpr float kForegroundWeight = 0.8F;
  float nearest2 = std::numeric_limits<float>::max();
  for (const Eigen::Vector3f& seed : seeds) {
    const Eigen::Vector3f offset = point - seed;
    const float height = offset.dot(up);
    nearest2 = std::min(nearest2, offset.squaredNorm() - height * height);
  }
  return kForegroundWeight - std::sqrt(std::max(0.0F, nearest2)) / radius_m;
}

float smoothnessCost(float length_m, float sigma_m) {
  const float relative = length_m / sigma_m;
  return std::exp(-relative * relative);
}

}  // namespace pf

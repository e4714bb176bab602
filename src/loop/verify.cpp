// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/verify.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "posefusion/core/same_pose.hpp"

namespace pf {
namespace {

// Rounds of drawing and aligning: the grid's pose may be 10 cm and 5 degrees off, from where the
// map shows other things than from the right one.
constexpr int kRounds = 3;
constexpr double kSettled_m = 0.01, kSettled_rad = 0.01;
// Of two places that look alike one is believed by odds of 150 to 1: so much more chi-square.
constexpr double kTellsApart = 10.0;
// Nothing is known before: a prior as wide as the gates.
constexpr double kPriorShift_m = 0.3, kPriorTurn_rad = 0.3;

bool isSamePlace(const PlaceVerdict& a, const PlaceVerdict& b) {
  const Eigen::Isometry3d step = a.alignment.T_map_camera.inverse() * b.alignment.T_map_camera;
  return a.fragment == b.fragment && isWithin(step, kSamePlace);
}

/// Of places that all look right (at least one) that where dead reckoning expects the camera, if by
/// far; else the best one, as ambiguous.
PlaceVerdict likeliest(std::vector<PlaceVerdict>& places, const ExpectedPlace* expected) {
  if (places.size() == 1) return places.front();
  const auto surprise = [&](const PlaceVerdict& place) {
    return expected == nullptr ? 0.0 : expected->chiSquare(place.pose());
  };
  std::stable_sort(places.begin(), places.end(),
                   [&](const auto& a, const auto& b) { return surprise(a) < surprise(b); });
  if (surprise(places[1]) - surprise(places[0]) < kTellsApart) {
    places[0].doubt = PlaceDoubt::ambiguous;
  }
  return places[0];
}

PlaceDoubt doubtOf(PoseSign weakest) {
  switch (weakest) {
    case PoseSign::overlap:
      return PlaceDoubt::little_overlap;
    case PoseSign::contradicted:
    case PoseSign::hidden:
      return PlaceDoubt::disagrees;
    case PoseSign::seen_through:
      return PlaceDoubt::seen_through;
    case PoseSign::correlation:
      return PlaceDoubt::other_picture;
    case PoseSign::view:
      return PlaceDoubt::covered;
    case PoseSign::log_spread:
    case PoseSign::log_sigma:
      return PlaceDoubt::degenerate;
  }
  return PlaceDoubt::degenerate;
}

}  // namespace

std::string_view name(PlaceDoubt doubt) {
  constexpr std::array<std::string_view, kPlaceDoubts> kNames = {
      "none",      "covered",      "little_overlap", "not_converged", "degenerate",
      "disagrees", "seen_through", "other_picture",  "ambiguous"};
  return kNames.at(static_cast<std::size_t>(doubt));
}

TrackingStart freeStart(const Eigen::Isometry3d& T_map_camera) {
  TrackingStart start;
  start.T_map_view = start.T_map_camera = start.prior.T_map_camera = T_map_camera;
  start.prior.covariance = independentCovariance(kPriorShift_m, kPriorTurn_rad);
  return start;
}

void judgePlace(PlaceVerdict& verdict, const TrackingConfig& config) {
  const PoseEvidence evidence = poseEvidence(poseSigns(verdict.alignment, verdict.agreement));
  verdict.log_odds = evidence.log_odds;
  if (!verdict.alignment.converged) {
    verdict.doubt = PlaceDoubt::not_converged;
  } else if (!isKnown(verdict.alignment)) {
    verdict.doubt = PlaceDoubt::degenerate;
  } else if (evidence.log_odds < logOdds(config.sure_to_return)) {
    verdict.doubt = doubtOf(evidence.weakest);
  } else {
    verdict.doubt = PlaceDoubt::none;
  }
}

ViewAgreement PlaceVerifier::compare(const SurfelMap& map, const WorkingFrame& frame,
                                     const MapPose& pose) {
  RenderOptions options;
  options.age = SurfelAge::all;
  options.fragment = pose.fragment;
  renderer_.render(map, frame.camera, pose.T_map_camera, options, view_);
  return compareViews(frame, view_);
}

PlaceVerdict PlaceVerifier::verify(const SurfelMap& map, const WorkingFrame& frame,
                                   const MapPose& candidate) {
  RenderOptions options;
  options.age = SurfelAge::all;
  options.fragment = candidate.fragment;
  PlaceVerdict verdict;
  verdict.fragment = candidate.fragment;
  verdict.alignment.T_map_camera = candidate.T_map_camera;
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Isometry3d T = verdict.alignment.T_map_camera;
    renderer_.render(map, frame.camera, T, options, view_);
    model_.assign(view_, frame.sensor);
    TrackingStart start = freeStart(T);
    start.brightness = verdict.alignment.brightness;
    verdict.alignment = track(frame, model_, start, tracking_);
    const Eigen::Isometry3d step = T.inverse() * verdict.alignment.T_map_camera;
    if (!verdict.alignment.converged && i > 0) break;
    if (step.translation().norm() < kSettled_m && angleOf(step) < kSettled_rad) break;
  }
  verdict.agreement = compare(map, frame, verdict.pose());
  judgePlace(verdict, tracking_);
  return verdict;
}

PlaceVerdict PlaceVerifier::verifyBest(const SurfelMap& map, const WorkingFrame& frame,
                                       const std::vector<PlaceCandidate>& candidates,
                                       std::size_t most, const ExpectedPlace* expected) {
  PlaceVerdict first;
  std::vector<PlaceVerdict> places;  // believed, the best of each
  for (std::size_t i = 0; i < std::min(most, candidates.size()); ++i) {
    const PlaceVerdict verdict = verify(map, frame, candidates[i].pose);
    if (i == 0) first = verdict;
    if (!verdict.accepted()) continue;
    const auto same = std::find_if(places.begin(), places.end(),
                                   [&](const auto& p) { return isSamePlace(p, verdict); });
    if (same == places.end()) {
      places.push_back(verdict);
    } else if (verdict.log_odds > same->log_odds) {
      *same = verdict;
    }
    if (places.size() > 1 && expected == nullptr) break;
  }
  if (places.empty()) return first;
  return likeliest(places, expected);
}

}  // namespace pf

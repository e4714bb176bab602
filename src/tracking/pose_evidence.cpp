// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/pose_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/symmetric.hpp"

namespace pf {
namespace {

/// One term of the model: `slope` for each unit of the sign between two places. A sign that speaks
/// for the pose adds from the first place on; one that speaks against takes off.
struct Term {
  PoseSign sign;
  double from, to, slope;
};

#include "pose_evidence_model.inc"

// Signs beyond these are counted as these, in training too.
constexpr double kLeastVisible = 0.05, kLeastSpread = 1e-3, kLeastSigma_m = 1e-3;

double valueOf(const Term& term, const PoseSigns& signs) {
  const double x = signs[static_cast<std::size_t>(term.sign)];
  return term.slope * (std::clamp(x, term.from, term.to) - term.from);
}

}  // namespace

bool isKnown(const TrackingResult& alignment) {
  return alignment.converged && positionSigma(alignment.covariance) <= kKnownSigma_m;
}

std::string_view name(PoseSign sign) {
  constexpr std::array<std::string_view, kPoseSigns> kNames = {
      "overlap",     "contradicted", "seen_through", "hidden",
      "correlation", "log_spread",   "view",         "log_sigma"};
  return kNames.at(static_cast<std::size_t>(sign));
}

PoseSigns poseSigns(const TrackingResult& alignment, const ViewAgreement& a) {
  // A person or thing new in front of the map does not contradict the place.
  const double visible = std::max(kLeastVisible, 1.0 - a.hidden);
  PoseSigns signs{};
  const auto set = [&](PoseSign sign, double value) {
    signs[static_cast<std::size_t>(sign)] = value;
  };
  set(PoseSign::overlap, a.overlap);
  set(PoseSign::contradicted, std::max(0.0, 1.0 - a.agreeing / visible));
  set(PoseSign::seen_through, a.seen_through);
  set(PoseSign::hidden, a.hidden);
  set(PoseSign::correlation, a.correlation);
  set(PoseSign::log_spread, std::log10(std::max(kLeastSpread, a.spread)));
  set(PoseSign::view, a.view);
  set(PoseSign::log_sigma,
      std::log10(std::max(kLeastSigma_m, positionSigma(alignment.covariance))));
  return signs;
}

PoseEvidence poseEvidence(const PoseSigns& signs) {
  PoseEvidence evidence;
  evidence.log_odds = kConstant;
  PoseSigns lost{};  // against the best value of each sign
  for (const Term& term : kTerms) {
    const double value = valueOf(term, signs);
    evidence.log_odds += value;
    const double best = std::max(0.0, term.slope * (term.to - term.from));
    lost[static_cast<std::size_t>(term.sign)] += best - value;
  }
  const auto most = std::max_element(lost.begin(), lost.end());
  evidence.weakest = static_cast<PoseSign>(most - lost.begin());
  return evidence;
}

PoseEvidence poseEvidence(const WorkingFrame& frame, const TrackingResult& alignment,
                          const ModelView& view) {
  return poseEvidence(poseSigns(alignment, compareViews(frame, view)));
}

double positionSigma(const Matrix6d& covariance) {
  return std::sqrt(std::max(0.0, eigenOf(covariance.topLeftCorner<3, 3>()).values[2]));
}

double logOdds(double probability) { return std::log(probability / (1.0 - probability)); }

}  // namespace pf

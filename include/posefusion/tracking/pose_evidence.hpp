// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "posefusion/tracking/result.hpp"
#include "posefusion/tracking/view_agreement.hpp"

namespace pf {

/// Standard deviation (m) of the camera's position in the direction that is known worst.
double positionSigma(const Matrix6d& covariance);

/// Of a position that is known: three of it are the 0.10 m beyond which a pose counts as wrong.
constexpr double kKnownSigma_m = 0.033;

/// The alignment settled, and says where the camera is. What it does not say it cannot prove.
bool isKnown(const TrackingResult& alignment);

/// What an alignment shows of whether its pose is right.
enum class PoseSign {
  overlap,       ///< part of the frame that is in the map
  contradicted,  ///< part of what the map shows and nothing hides, that the frame does not
  seen_through,  ///< part of the map's surfaces that the frame sees through
  hidden,        ///< part of them behind something else
  correlation,   ///< of the grey levels
  log_spread,    ///< of the normals, decimal logarithm
  view,          ///< part of the frame with depth
  log_sigma      ///< of the position (m), decimal logarithm
};
constexpr std::size_t kPoseSigns = 8;
std::string_view name(PoseSign sign);
using PoseSigns = std::array<double, kPoseSigns>;  ///< by PoseSign

PoseSigns poseSigns(const TrackingResult& alignment, const ViewAgreement& agreement);

/// How far an alignment speaks for its pose.
struct PoseEvidence {
  double log_odds = 0;  ///< natural logarithm of the likelihood ratio of right against wrong
  PoseSign weakest = PoseSign::overlap;  ///< what speaks most against it
};

/// A logistic model with monotone terms, fitted to right and wrong poses in simulated rooms by
/// training/pose_evidence.py, of alignments that are known; right: within 0.10 m and 5 degrees.
PoseEvidence poseEvidence(const PoseSigns& signs);
/// `view`: the map from the pose of the alignment.
PoseEvidence poseEvidence(const WorkingFrame& frame, const TrackingResult& alignment,
                          const ModelView& view);

/// The log-odds of a probability, of (0, 1).
double logOdds(double probability);

}  // namespace pf

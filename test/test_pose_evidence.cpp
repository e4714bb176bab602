// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/pose_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "place_scene.hpp"
#include "posefusion/loop/verify.hpp"

namespace pf {
namespace {

constexpr std::size_t at(PoseSign sign) { return static_cast<std::size_t>(sign); }

/// Least and most of each sign, and whether more of it speaks for the pose.
struct Range {
  PoseSign sign;
  double least, most;
  bool speaks_for;
};
const std::array<Range, kPoseSigns> kRanges = {{{PoseSign::overlap, 0, 1, true},
                                                {PoseSign::contradicted, 0, 1, false},
                                                {PoseSign::seen_through, 0, 1, false},
                                                {PoseSign::hidden, 0, 1, false},
                                                {PoseSign::correlation, -1, 1, true},
                                                {PoseSign::log_spread, -3, -0.5, true},
                                                {PoseSign::view, 0, 1, true},
                                                {PoseSign::log_sigma, -3, -1, false}}};

PoseSigns mixed(double share_of_best) {
  PoseSigns signs{};
  for (const Range& r : kRanges) {
    const double share = r.speaks_for ? share_of_best : 1.0 - share_of_best;
    signs[at(r.sign)] = r.least + share * (r.most - r.least);
  }
  return signs;
}

TEST(PoseEvidence, NoSignSpeaksAgainstItsMeaning) {
  for (const Range& r : kRanges) {
    PoseSigns signs = mixed(0.5);
    double before = 0;
    for (int step = 0; step <= 20; ++step) {
      signs[at(r.sign)] = r.least + step / 20.0 * (r.most - r.least);
      const double now = poseEvidence(signs).log_odds;
      if (step > 0) {
        EXPECT_GE(r.speaks_for ? now - before : before - now, -1e-12) << name(r.sign);
      }
      before = now;
    }
  }
}

TEST(PoseEvidence, TheBestSignsSpeakForAPoseAndTheWorstAgainst) {
  EXPECT_GT(poseEvidence(mixed(1.0)).log_odds, logOdds(0.99));
  EXPECT_LT(poseEvidence(mixed(0.0)).log_odds, logOdds(0.01));
}

TEST(PoseEvidence, NamesWhatSpeaksMostAgainst) {
  for (const PoseSign sign : {PoseSign::correlation, PoseSign::seen_through, PoseSign::log_sigma}) {
    PoseSigns signs = mixed(1.0);
    signs[at(sign)] = mixed(0.0)[at(sign)];
    EXPECT_EQ(poseEvidence(signs).weakest, sign) << name(sign);
  }
}

TEST(PoseEvidence, LogOddsOfAProbability) {
  EXPECT_DOUBLE_EQ(logOdds(0.5), 0.0);
  EXPECT_NEAR(1.0 / (1.0 + std::exp(-logOdds(0.98))), 0.98, 1e-12);
}

TEST(PoseEvidence, IsKnownWhereItSettledAndSaysWhereTheCameraIs) {
  TrackingResult alignment;  // covariance 0, as of one that never began
  EXPECT_FALSE(isKnown(alignment));
  alignment.converged = true;
  for (const double sigma_m : {0.032, 0.034}) {
    alignment.covariance = independentCovariance(sigma_m, 0.001);
    EXPECT_EQ(isKnown(alignment), sigma_m < kKnownSigma_m);
  }
}

TEST(PoseEvidence, WhatHidesTheMapDoesNotContradictIt) {
  TrackingResult aligned;
  aligned.converged = true;
  ViewAgreement agreement;
  agreement.hidden = 0.4;
  agreement.agreeing = 0.6;
  EXPECT_NEAR(poseSigns(aligned, agreement)[at(PoseSign::contradicted)], 0.0, 1e-12);
  agreement.agreeing = 0.3;
  EXPECT_NEAR(poseSigns(aligned, agreement)[at(PoseSign::contradicted)], 0.5, 1e-12);
}

/// Every frame of the room that was mapped, at its pose and beside it.
TEST(PoseEvidence, TellsTruePosesFromFalseOnesInAMappedRoom) {
  SurfelRenderer renderer;
  ModelView view;
  RenderOptions options;
  options.age = SurfelAge::all;
  Vector6d aside = Vector6d::Zero();
  aside[0] = 0.3;
  aside[4] = 0.2;
  for (int i = 8; i < room().sequence.frameCount(); i += 7) {
    const WorkingFrame frame = room().frame(i);
    double log_odds[2] = {};
    for (const bool is_true : {true, false}) {
      TrackingResult at_pose;
      at_pose.converged = true;
      at_pose.covariance = independentCovariance(0.004, 0.002);
      at_pose.T_map_camera =
          room().sequence.pose(i) * (is_true ? Eigen::Isometry3d::Identity() : expSe3(aside));
      renderer.render(room().map, frame.camera, at_pose.T_map_camera, options, view);
      log_odds[is_true ? 1 : 0] = poseEvidence(frame, at_pose, view).log_odds;
    }
    EXPECT_GT(log_odds[1], logOdds(TrackingConfig{}.sure_to_return)) << i;
    EXPECT_LT(log_odds[0], 0.0) << i;
  }
}

}  // namespace
}  // namespace pf

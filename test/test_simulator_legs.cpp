// SPDX-License-Identifier: BSD-3-Clause
// Simulated legs and necks measure the true motion, with the errors of the settings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "posefusion/core/se3.hpp"
#include "simulator/legs.hpp"
#include "simulator_paths.hpp"

namespace pf::simulator {
namespace {

using Eigen::Isometry3d;

constexpr TimeSpan kWalk{0.0, 40.0};

LegsConfig exactLegs() {
  LegsConfig c;
  c.encoder_counts = 0;
  c.scale_percent = c.turn_percent = c.slip_every_s = 0.0;
  c.drift_m_per_m = c.drift_deg_per_m = c.drift_deg_per_turn = 0.0;
  c.falls_confuse = false;
  return c;
}

Isometry3d cameraOf(const LegSample& sample) { return sample.T_odom_base * sample.T_base_camera; }

/// Error of the measured motion between two samples (m plus rad).
double motionError(const CameraPath& path, const LegSample& a, const LegSample& b) {
  const Isometry3d sensed = cameraOf(a).inverse() * cameraOf(b);
  const Isometry3d truth = path.at(a.time_s).inverse() * path.at(b.time_s);
  const Isometry3d error = sensed.inverse() * truth;
  return error.translation().norm() + angleOf(error);
}

std::unique_ptr<CameraPath> fallingRobot() {
  return walkingRobot({{8.0, "forward", 3.0, 0.5, 0.5}, {24.0, "backward", 2.0, 0.3, -0.5}});
}

TEST(SimulatorLegs, WithoutErrorsOdometryAndNeckMakeTheCamerasPath) {
  const auto walks = walkingRobot(), falls = fallingRobot();
  const auto hand = makeHandHeld(HandHeld(), 5U);
  for (const CameraPath* path : {walks.get(), falls.get(), hand.get()}) {
    const auto samples = senseLegs(*path, exactLegs(), kWalk, 7U);
    ASSERT_EQ(samples.size(), 2001U);
    for (const LegSample& sample : samples) {
      EXPECT_LT(motionError(*path, samples.front(), sample), 1e-6) << sample.time_s;
    }
  }
}

TEST(SimulatorLegs, OdometryBeginsAtItsOriginAndIsLevel) {
  const auto path = walkingRobot();
  const auto samples = senseLegs(*path, LegsConfig(), kWalk, 7U);
  const Isometry3d& first = samples.front().T_odom_base;
  EXPECT_EQ(first.translation().norm(), 0.0);
  EXPECT_NEAR(headingOf(first.linear()), 0.0, 1e-9);
  for (const LegSample& sample : samples) {
    EXPECT_GT(sample.T_odom_base.linear()(2, 2), 0.998) << sample.time_s;
    EXPECT_NEAR(sample.T_odom_base.translation().z(), 0.0, 0.15) << sample.time_s;
  }
}

TEST(SimulatorLegs, TheBodyFacesWhereItWalksAndTheNeckDoesTheRest) {
  const auto path = walkingRobot();
  const LegsConfig config = exactLegs();
  const Body body(*path, config, kWalk);
  int ahead = 0, aside = 0;
  for (double t = 0.0; t < kWalk.end_s; t += 0.1) {
    const BodyPose pose = body.at(t);
    EXPECT_NEAR(pose.T_world_base.translation().z(), 1.40 - config.neck_m, 0.06) << t;
    const Eigen::Vector2d at = pose.T_world_base.translation().head<2>();
    if (at.x() > 1.8 && at.x() < 4.2) {
      EXPECT_NEAR(headingOf(pose.T_world_base.linear()), 0.0, 0.1) << t;
      EXPECT_NEAR(pose.neck.yaw_rad, 0.0, 0.15) << t;
      ++ahead;
    }
    if (at.y() > 1.8 && at.y() < 4.2) {
      EXPECT_NEAR(headingOf(pose.T_world_base.linear()), 80.0 * M_PI / 180.0, 0.1) << t;
      EXPECT_NEAR(pose.neck.yaw_rad, -80.0 * M_PI / 180.0, 0.15) << t;
      ++aside;
    }
  }
  EXPECT_GT(ahead, 50);
  EXPECT_GT(aside, 50);
}

TEST(SimulatorLegs, TheNeckIsMeasuredInStepsOfItsEncoders) {
  LegsConfig config = exactLegs();
  config.encoder_counts = 1024;
  const double step_rad = 2.0 * M_PI / 1024;
  const auto path = walkingRobot();
  const auto samples = senseLegs(*path, config, kWalk, 7U);
  const Body body(*path, config, kWalk);
  for (const LegSample& sample : samples) {
    const NeckAngles exact = body.at(sample.time_s).neck;
    EXPECT_NEAR(std::remainder(sample.neck.yaw_rad, step_rad), 0.0, 1e-9);
    EXPECT_LE(std::abs(sample.neck.yaw_rad - exact.yaw_rad), 0.5 * step_rad + 1e-9);
    EXPECT_LE(std::abs(sample.neck.pitch_rad - exact.pitch_rad), 0.5 * step_rad + 1e-9);
    EXPECT_TRUE(sample.T_base_camera.isApprox(baseFromCamera(config, sample.neck)));
  }
}

TEST(SimulatorLegs, DriftGrowsByTheSettings) {
  LegsConfig config = exactLegs();
  config.drift_m_per_m = 0.02;
  config.drift_deg_per_turn = 3.0;
  const auto path = walkingRobot();
  constexpr int kSeeds = 40;
  double place = 0.0, heading = 0.0;
  LegVariance expected;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    const auto samples = senseLegs(*path, config, kWalk, seed);
    const LegSample& last = samples.back();
    const Isometry3d sensed = samples.front().T_odom_base.inverse() * last.T_odom_base;
    const auto exact = senseLegs(*path, exactLegs(), kWalk, seed);
    const Isometry3d truth = exact.front().T_odom_base.inverse() * exact.back().T_odom_base;
    place += std::pow(sensed.translation().z() - truth.translation().z(), 2);
    heading += std::pow(headingOf(sensed.linear()) - headingOf(truth.linear()), 2);
    expected = varianceOf(config, last.way_m, last.turned_rad);
    EXPECT_NEAR(last.way_m, 8.0, 1.0);
  }
  EXPECT_NEAR(std::sqrt(place / kSeeds), std::sqrt(expected.place_m2),
              0.3 * std::sqrt(expected.place_m2));
  EXPECT_NEAR(std::sqrt(heading / kSeeds), std::sqrt(expected.heading_rad2),
              0.3 * std::sqrt(expected.heading_rad2));
}

TEST(SimulatorLegs, AScaleMakesAllWaysLongerOrShorter) {
  LegsConfig config = exactLegs();
  config.scale_percent = 5.0;
  const auto path = walkingRobot();
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const auto samples = senseLegs(*path, config, {0.0, 12.0}, seed);
    const auto exact = senseLegs(*path, exactLegs(), {0.0, 12.0}, seed);
    const double scale =
        samples.back().T_odom_base.translation().x() / exact.back().T_odom_base.translation().x();
    EXPECT_LE(std::abs(scale - 1.0), 0.05);
    EXPECT_GT(std::abs(scale - 1.0), 1e-4);
  }
}

TEST(SimulatorLegs, ASlipIsAStepThatIsNotThere) {
  LegsConfig config = exactLegs();
  config.slip_every_s = 6.0;
  config.slip_m = 0.08;
  const auto path = walkingRobot();
  const auto samples = senseLegs(*path, config, kWalk, 7U);
  double slipped_s = 0.0, way_m = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double error = motionError(*path, samples[i - 1], samples[i]);
    slipped_s += error > 1e-6 ? 0.02 : 0.0;
    way_m += error;
    if (samples[i].time_s < 1.0) {
      EXPECT_LT(error, 1e-6) << "it stands";
    }
  }
  EXPECT_GT(slipped_s, 0.2);
  EXPECT_LE(slipped_s, 7 * 0.28);
  EXPECT_GT(way_m, 0.02);
  EXPECT_LE(way_m, 7 * (0.09 + 3.2 * M_PI / 180.0));
}

TEST(SimulatorLegs, LegsMeasureAnythingInAFallAndTheTruthOutsideOfIt) {
  LegsConfig config = exactLegs();
  config.falls_confuse = true;
  const auto path = fallingRobot();
  const auto falls = path->events();
  ASSERT_EQ(falls.size(), 2U);
  int jumps = 0, moves = 0, stands = 0;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    const auto samples = senseLegs(*path, config, kWalk, seed);
    for (const Event& fall : falls) {
      double longest_m = 0.0, way_m = 0.0, error = 0.0;
      for (std::size_t i = 1; i < samples.size(); ++i) {
        if (samples[i].time_s <= fall.start_s || samples[i].time_s > fall.end_s) continue;
        const double step_m =
            (samples[i].T_odom_base.translation() - samples[i - 1].T_odom_base.translation())
                .norm();
        longest_m = std::max(longest_m, step_m);
        way_m += step_m;
        error += motionError(*path, samples[i - 1], samples[i]);
      }
      EXPECT_GT(error, 0.5);
      (way_m == 0.0 ? stands : longest_m > 0.2 ? jumps : moves) += 1;
    }
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double t = samples[i].time_s;
      const bool inside = std::any_of(falls.begin(), falls.end(), [&](const Event& fall) {
        return t > fall.start_s && t <= fall.end_s;
      });
      if (!inside) {
        EXPECT_LT(motionError(*path, samples[i - 1], samples[i]), 1e-6) << t;
      }
    }
  }
  EXPECT_GT(stands, 1);
  EXPECT_GT(jumps, 1);
  EXPECT_GT(moves, 1);
}

TEST(SimulatorLegs, SameSeedSameSamples) {
  const auto path = fallingRobot();
  const auto a = senseLegs(*path, LegsConfig(), kWalk, 7U),
             b = senseLegs(*path, LegsConfig(), kWalk, 7U),
             c = senseLegs(*path, LegsConfig(), kWalk, 8U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].T_odom_base.matrix(), b[i].T_odom_base.matrix());
    EXPECT_EQ(a[i].T_base_camera.matrix(), b[i].T_base_camera.matrix());
  }
  EXPECT_FALSE(a.back().T_odom_base.isApprox(c.back().T_odom_base, 1e-4));
}

}  // namespace
}  // namespace pf::simulator

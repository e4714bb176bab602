// SPDX-License-Identifier: BSD-3-Clause
// The simulated inertial sensor measures the camera's motion, with the errors of the settings.
#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/core/se3.hpp"
#include "simulator/imu.hpp"
#include "simulator_paths.hpp"

namespace pf::simulator {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

ImuConfig exactConfig() {
  ImuConfig c;
  c.gyro_noise_rad_s_rthz = c.accel_noise_m_s2_rthz = 0.0;
  c.gyro_walk_rad_s2_rthz = c.accel_walk_m_s3_rthz = 0.0;
  c.gyro_bias_rad_s = c.accel_bias_m_s2 = c.shock = 0.0;
  return c;
}

Isometry3d imuAt(const CameraPath& path, const ImuConfig& config, double t) {
  return path.at(t) * imuFromCamera(config).inverse();
}

/// The angle between the turn that the rates of a span make and the true one.
double turnError(const CameraPath& path, const ImuConfig& config, const TimeSpan& span) {
  const double half_s = 0.5 / config.rate_hz;
  Matrix3d turn = Matrix3d::Identity();
  for (const ImuSample& sample : senseImu(path, config, span, 7U)) {
    turn = turn * expSo3(sample.rate_rad_s / config.rate_hz);
  }
  const Matrix3d from = imuAt(path, config, span.start_s - half_s).linear();
  const Matrix3d to = imuAt(path, config, span.end_s + half_s).linear();
  return logSo3(turn.transpose() * from.transpose() * to).norm();
}

std::unique_ptr<CameraPath> swingingCamera(const char* pattern, double shake) {
  HandHeld spec;
  spec.pattern = pattern;
  spec.shake = shake;
  return makeHandHeld(spec, 5U);
}

FunctionPath dropped() {
  return FunctionPath([](double t) {
    Isometry3d T = lookAt({0, 0, 2}, {2, 1, 1});
    T.pretranslate(Vector3d(0.3 * t, 0.0, -0.5 * kGravity_m_s2 * t * t));
    return T;
  });
}

TEST(SimulatorImu, RatesOfASecondMakeTheTrueTurn) {
  const auto robot = walkingRobot(), hand = swingingCamera("rpy", 1.0);
  for (double start_s = 2.0; start_s < 30.0; start_s += 3.0) {
    for (const CameraPath* path : {robot.get(), hand.get()}) {
      const TimeSpan second{start_s, start_s + 1.0};
      EXPECT_LT(turnError(*path, exactConfig(), second), 1e-9);
      ImuConfig noisy = exactConfig();
      noisy.gyro_noise_rad_s_rthz = 2.4e-4;
      EXPECT_LT(turnError(*path, noisy, second), 4.0 * std::sqrt(3.0) * 2.4e-4);
      EXPECT_LT(turnError(*path, ImuConfig(), second), 4.0 * std::sqrt(3.0) * 5e-3);
    }
  }
}

TEST(SimulatorImu, ForceAtRestIsGravityUpwards) {
  const auto tripod = swingingCamera("static", 0.0);
  const Matrix3d R = imuAt(*tripod, exactConfig(), 0.0).linear();
  for (const ImuSample& sample : senseImu(*tripod, exactConfig(), {0.0, 1.0}, 7U)) {
    EXPECT_LT((R * sample.force_m_s2 - Vector3d(0, 0, 9.81)).norm(), 1e-6);
    EXPECT_LT(sample.rate_rad_s.norm(), 1e-9);
  }
}

TEST(SimulatorImu, ThereIsNoForceInFreeFall) {
  const FunctionPath path = dropped();
  for (const ImuSample& sample : senseImu(path, exactConfig(), {0.2, 1.0}, 7U)) {
    EXPECT_LT(sample.force_m_s2.norm(), 1e-6);
  }
  for (const ImuSample& sample : senseImu(path, ImuConfig(), {0.2, 1.0}, 7U)) {
    EXPECT_LT(sample.force_m_s2.norm(), 0.4);
  }
}

TEST(SimulatorImu, ForcesOfASmoothPathSummedTwiceMakeThePath) {
  const ImuConfig config = exactConfig();
  const double step_s = 1.0 / config.rate_hz;
  for (const char* pattern : {"xyz", "rpy", "halfsphere"}) {
    const auto path = swingingCamera(pattern, 1.0);
    Vector3d before = imuAt(*path, config, 1.0 - step_s).translation();
    Vector3d now = imuAt(*path, config, 1.0).translation();
    for (const ImuSample& sample : senseImu(*path, config, {1.0, 6.0}, 7U)) {
      const Vector3d force = imuAt(*path, config, sample.time_s).linear() * sample.force_m_s2;
      const Vector3d next =
          2.0 * now - before + step_s * step_s * (force - kGravity_m_s2 * Vector3d::UnitZ());
      before = now;
      now = next;
    }
    EXPECT_LT((now - imuAt(*path, config, 6.0 + step_s).translation()).norm(), 1e-6) << pattern;
  }
}

TEST(SimulatorImu, ForceIsAtFullScaleWhereTheBodyHitsTheFloorAndNowhereElse) {
  for (const char* direction : {"forward", "backward", "sideways"}) {
    const auto path = walkingRobot({{8.0, direction, 3.0, 0.5, 0.5}});
    const Event fall = path->events().at(0);
    const ImuConfig config;
    double drop = 1e9, before = 0.0;
    int at_full_scale = 0;
    for (const ImuSample& sample : senseImu(*path, config, {0.0, 20.0}, 7U)) {
      const bool falls = sample.time_s > fall.start_s && sample.time_s < fall.end_s;
      const double most = sample.force_m_s2.cwiseAbs().maxCoeff();
      EXPECT_LE(most, 16.0 * kGravity_m_s2 + 1e-9);
      EXPECT_LE(sample.rate_rad_s.cwiseAbs().maxCoeff(), 2000.0 * M_PI / 180.0);
      at_full_scale += falls && most > 16.0 * kGravity_m_s2 - 1e-9 ? 1 : 0;
      if (!falls) before = std::max(before, most);
      if (sample.time_s > fall.start_s + 0.5 && sample.time_s < fall.start_s + 0.9) {
        drop = std::min(drop, sample.force_m_s2.norm());
      }
    }
    EXPECT_GE(at_full_scale, 1) << direction;
    EXPECT_LT(before, 5.0 * kGravity_m_s2) << direction;
    EXPECT_LT(drop, 0.6 * kGravity_m_s2) << direction;
  }
}

TEST(SimulatorImu, NoiseAndBiasAreThoseOfTheSettings) {
  const auto tripod = swingingCamera("static", 0.0);
  ImuConfig config = exactConfig();
  config.gyro_noise_rad_s_rthz = 1e-3;
  double squares = 0.0;
  const auto noisy = senseImu(*tripod, config, {0.0, 50.0}, 7U);
  for (const ImuSample& sample : noisy) squares += sample.rate_rad_s.squaredNorm();
  EXPECT_NEAR(std::sqrt(squares / (3.0 * static_cast<double>(noisy.size()))),
              1e-3 * std::sqrt(200.0), 3e-4);
  config = exactConfig();
  config.gyro_bias_rad_s = 1e-2;
  config.gyro_walk_rad_s2_rthz = 1e-3;
  double first = 0.0, walked = 0.0;
  constexpr int kSeeds = 60;
  for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
    const auto samples = senseImu(*tripod, config, {0.0, 4.0}, seed);
    first += samples.front().rate_rad_s.squaredNorm();
    walked += (samples.back().rate_rad_s - samples.front().rate_rad_s).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(first / (3.0 * kSeeds)), 1e-2, 1.5e-3);
  EXPECT_NEAR(std::sqrt(walked / (3.0 * kSeeds)), 1e-3 * std::sqrt(4.0), 3e-4);
}

TEST(SimulatorImu, SameSeedSameSamples) {
  const auto path = walkingRobot();
  const auto a = senseImu(*path, ImuConfig(), {0.0, 2.0}, 7U),
             b = senseImu(*path, ImuConfig(), {0.0, 2.0}, 7U),
             c = senseImu(*path, ImuConfig(), {0.0, 2.0}, 8U);
  ASSERT_EQ(a.size(), 401U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].rate_rad_s, b[i].rate_rad_s);
    EXPECT_EQ(a[i].force_m_s2, b[i].force_m_s2);
    EXPECT_NE(a[i].rate_rad_s, c[i].rate_rad_s);
  }
}

}  // namespace
}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/robot/robot_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace pf {
namespace {

constexpr double kSeconds = 8;
const Matrix6d kSeen = independentCovariance(0.001, 0.001);

std::int64_t stampAt(double s) {
  return 1'000'000'000 + static_cast<std::int64_t>(std::lround(1e9 * s));
}

/// The true pose: the camera rests for a second, then walks and looks around.
Eigen::Isometry3d poseAt(double s) {
  const double t = std::max(0.0, s - 1);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.5 * std::sin(0.7 * t), 0.05 * std::sin(6 * t), 0.4 * t;
  T.linear() = expSo3({0.1 * std::sin(2 * t), 0.6 * std::sin(0.9 * t), 0});
  return T;
}

Eigen::Vector3d rateAt(double s) {
  constexpr double h = 1e-4;
  return logSo3(poseAt(s - h).linear().transpose() * poseAt(s + h).linear()) / (2 * h);
}

/// Odometry at 50 Hz, its poses by `odometry`.
RobotMotion walked(const std::function<Eigen::Isometry3d(double)>& odometry,
                   double until = kSeconds) {
  RobotMotion robot((RobotConfig()));
  double sent = 0;
  for (double s = 0.1; s < until; s += 1.0 / 30) {
    for (; sent < s + 0.02; sent += 0.02) robot.addOdometry({stampAt(sent), odometry(sent)});
    robot.compare(stampAt(s - 1.0 / 30), stampAt(s), poseAt(s - 1.0 / 30).inverse() * poseAt(s),
                  kSeen);
  }
  return robot;
}

double errorOf(const MotionPrior& prior, double from, double to) {
  return (prior.T_before_after.inverse() * poseAt(from).inverse() * poseAt(to))
      .translation()
      .norm();
}

TEST(RobotMotion, OdometryThatAgreesWithTheImagesIsUsed) {
  const Eigen::Isometry3d anywhere = poseAt(3.3) * poseAt(2);
  RobotMotion robot = walked([&](double s) { return anywhere * poseAt(s); });
  ASSERT_TRUE(robot.odometry().is_believed);
  const auto prior = robot.between(stampAt(7.31), stampAt(7.345));
  ASSERT_TRUE(prior);
  EXPECT_TRUE(prior->has_shift);
  EXPECT_LT(errorOf(*prior, 7.31, 7.345), 0.001) << "between its own stamps";
  EXPECT_FALSE(robot.between(stampAt(7.3), stampAt(8.5))) << "what is not there yet is not awaited";
  EXPECT_FALSE(robot.between(stampAt(-2), stampAt(7.3)));
  EXPECT_EQ(robot.odometry().told, 1U);
  EXPECT_EQ(robot.odometry().missing, 2U);
}

TEST(RobotMotion, StandingStillShowsNothing) {
  const RobotMotion robot = walked([](double) { return Eigen::Isometry3d::Identity(); }, 1.0);
  EXPECT_FALSE(robot.odometry().is_believed);
}

/// Share of the motions reported in the last second that are within three of their sigmas.
double shareWithin(RobotMotion& robot, double until) {
  int motions = 0, within = 0;
  for (double s = until - 1; s < until - 0.04; s += 0.02) {
    const auto prior = robot.between(stampAt(s), stampAt(s + 1.0 / 30));
    if (!prior) continue;
    const Vector6d error =
        logSe3(prior->T_before_after.inverse() * poseAt(s).inverse() * poseAt(s + 1.0 / 30));
    ++motions;
    within += (error.array().square() < 9 * prior->covariance.diagonal().array()).all() ? 1 : 0;
  }
  return motions > 0 ? static_cast<double>(within) / motions : 1;
}

/// Ten kinds of wrong odometry.
TEST(RobotMotion, GarbageIsRejectedOrHasALargeCovariance) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto turned = [](double yaw) {
    return Eigen::Isometry3d(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()));
  };
  const Eigen::Isometry3d mixed_up(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  const std::vector<std::pair<const char*, std::function<Eigen::Isometry3d(double)>>> kinds = {
      {"frozen", [](double) { return Eigen::Isometry3d::Identity(); }},
      {"twice as far",
       [](double s) {
         Eigen::Isometry3d T = poseAt(s);
         T.translation() *= 2;
         return T;
       }},
      {"millimetres",
       [](double s) {
         Eigen::Isometry3d T = poseAt(s);
         T.translation() *= 1000;
         return T;
       }},
      {"backwards", [](double s) { return poseAt(s).inverse(); }},
      {"other axes", [&](double s) { return poseAt(s) * mixed_up; }},
      {"half a second late", [](double s) { return poseAt(s - 0.5); }},
      {"noise",
       [&](double s) {
         Eigen::Isometry3d T = poseAt(s);
         T.translation() += 0.1 * Eigen::Vector3d(normal(random), normal(random), normal(random));
         return T;
       }},
      {"walks alone",
       [](double s) {
         Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
         T.translation().z() = 0.5 * s;
         return T;
       }},
      {"spins", [&](double s) { return poseAt(s) * turned(3 * s); }},
      {"jumps",
       [](double s) {
         Eigen::Isometry3d T = poseAt(s);
         T.translation().x() += std::floor(5 * s);
         return T;
       }},
  };
  for (const auto& [name, odometry] : kinds) {
    for (double until = 0.5; until <= kSeconds; until += 0.5) {
      RobotMotion robot = walked(odometry, until);
      if (!robot.odometry().is_believed) continue;
      // If it is used, its covariance must cover the error.
      EXPECT_GE(shareWithin(robot, until), 0.9) << name << " after " << until << " s";
    }
  }
}

TEST(RobotMotion, IsRejectedOnceItGoesWrongAndUsedAgainOnceItIsRight) {
  const auto stopping = [](double s) {
    Eigen::Isometry3d T = poseAt(std::min(s, 4.0));
    if (s > 5) T = T * poseAt(5).inverse() * poseAt(s);
    return T;
  };
  EXPECT_TRUE(walked(stopping, 3.9).odometry().is_believed);
  EXPECT_FALSE(walked(stopping, 4.6).odometry().is_believed) << "it stopped";
  EXPECT_TRUE(walked(stopping, 8).odometry().is_believed);
}

TEST(RobotMotion, ErrorsLargerThanConfiguredRaiseTheCovariance) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Eigen::Isometry3d T = poseAt(0);
  double last = 0;
  const RobotMotion exact = walked(poseAt);
  RobotMotion rough = walked([&](double s) {
    Vector6d noise = Vector6d::Zero();
    for (int i = 0; i < 3; ++i) noise[i] = 0.005 * normal(random);
    T = T * poseAt(last).inverse() * poseAt(s) * expSe3(noise);
    last = s;
    return T;
  });
  RobotMotion fine = exact;
  ASSERT_TRUE(rough.odometry().is_believed);
  const auto a = fine.between(stampAt(7.3), stampAt(7.34)),
             b = rough.between(stampAt(7.3), stampAt(7.34));
  ASSERT_TRUE(a && b);
  EXPECT_GT(b->covariance(0, 0), 3 * a->covariance(0, 0));
}

TEST(RobotMotion, UnusableInputIsCountedAndNamed) {
  RobotMotion robot((RobotConfig()));
  robot.addOdometry({stampAt(1), poseAt(1)});
  robot.addOdometry({stampAt(0.5), poseAt(0.5)});
  EXPECT_NE(robot.odometry().why_left_out.find("not later"), std::string::npos);
  Eigen::Isometry3d bad = poseAt(1);
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  robot.addOdometry({stampAt(2), bad});
  bad = Eigen::Isometry3d::Identity();
  bad.linear().setZero();  // of a quaternion of zeros
  robot.addOdometry({stampAt(3), bad});
  EXPECT_NE(robot.odometry().why_left_out.find("rigid"), std::string::npos);
  EXPECT_EQ(robot.odometry().received, 4U);
  EXPECT_EQ(robot.odometry().left_out, 3U);
  ImuSample sample{
      stampAt(1), {0, 0, std::numeric_limits<double>::infinity()}, Eigen::Vector3d::Zero()};
  robot.addImu(sample);
  EXPECT_EQ(robot.imu().left_out, 1U);
}

/// Samples at 200 Hz of a sensor with a bias; odometry at 50 Hz.
RobotMotion withImu(const Eigen::Vector3d& bias, double until,
                    const std::function<Eigen::Vector3d(double)>& felt) {
  RobotMotion robot((RobotConfig()));
  double sent = 0, walked = 0;
  for (double s = 0.1; s < until; s += 1.0 / 30) {
    for (; sent < s + 0.006; sent += 0.005)
      robot.addImu({stampAt(sent), rateAt(sent) + bias, felt(sent)});
    for (; walked < s + 0.02; walked += 0.02) robot.addOdometry({stampAt(walked), poseAt(walked)});
    robot.compare(stampAt(s - 1.0 / 30), stampAt(s), poseAt(s - 1.0 / 30).inverse() * poseAt(s),
                  kSeen);
  }
  return robot;
}

const auto kAtRest = [](double) { return Eigen::Vector3d(0, -9.81, 0); };

TEST(RobotMotion, AnImuMeasuresTheTurnAndItsBiasIsLearned) {
  const Eigen::Vector3d bias(0.02, -0.03, 0.01);
  RobotMotion robot = withImu(bias, kSeconds, kAtRest);
  ASSERT_TRUE(robot.imu().is_believed);
  const auto prior = robot.between(stampAt(7.2), stampAt(7.5));
  ASSERT_TRUE(prior);
  const Eigen::Matrix3d off = prior->T_before_after.linear().transpose() *
                              poseAt(7.2).linear().transpose() * poseAt(7.5).linear();
  EXPECT_LT(logSo3(off).norm(), 0.001);
  EXPECT_TRUE(prior->has_shift) << "of the odometry";
}

TEST(RobotMotion, WhatTheSensorCannotMeasureIsNotReported) {
  RobotConfig config;
  config.gyro_full_scale_rad_s = 0.5;
  ImuTrack imu(config);
  for (double s = 0; s < 3; s += 0.005)
    imu.add({stampAt(s), {0, s < 2 ? 0.1 : 0.6, 0}, {0, -9.81, 0}});
  EXPECT_TRUE(imu.between(stampAt(1), stampAt(1.1)));
  EXPECT_FALSE(imu.between(stampAt(1.95), stampAt(2.05)));
}

TEST(RobotMotion, LegsAreNotUsedInAFallUntilTheyAgreeAgain) {
  const auto falls = [](double s) {
    return Eigen::Vector3d(0, s > 6 && s < 6.3 ? -0.5 : -9.81, 0);
  };
  RobotMotion before = withImu(Eigen::Vector3d::Zero(), 5.9, falls),
              in = withImu(Eigen::Vector3d::Zero(), 6.4, falls),
              after = withImu(Eigen::Vector3d::Zero(), 7.9, falls);
  EXPECT_TRUE(before.between(stampAt(5.8), stampAt(5.83))->has_shift);
  EXPECT_FALSE(in.between(stampAt(6.3), stampAt(6.33))->has_shift) << "the IMU's turn alone";
  EXPECT_TRUE(after.between(stampAt(7.8), stampAt(7.83))->has_shift);
}

}  // namespace
}  // namespace pf

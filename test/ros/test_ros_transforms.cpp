// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/transforms.hpp"

#include <gtest/gtest.h>
#include <tf2_eigen/tf2_eigen.h>

#include <Eigen/Cholesky>
#include <atomic>
#include <random>
#include <thread>

namespace posefusion_ros {
namespace {

using pf::Matrix6d;
using pf::Vector6d;

/// base -> camera at a time, moved along x by the time.
geometry_msgs::TransformStamped mountAt(double seconds) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation().x() = seconds;
  geometry_msgs::TransformStamped message = tf2::eigenToTransform(T);
  message.header.stamp = ros::Time(seconds);
  message.header.frame_id = "base";
  message.child_frame_id = "camera";
  return message;
}

class TransformLookupTest : public testing::Test {
 protected:
  void hear(double seconds) { buffer.setTransform(mountAt(seconds), "test"); }
  std::optional<double> find(TransformLookup& lookup, double stamp_s) {
    const auto T = lookup.find("base", "camera", ros::Time(stamp_s), note);
    return T ? std::optional<double>(T->translation().x()) : std::nullopt;
  }

  tf2::BufferCore buffer;
  std::string note;
};

TEST_F(TransformLookupTest, AMissingSenderHoldsUpOneFrameOnly) {
  for (const bool exact : {false, true}) {
    TransformLookup lookup(buffer, {0.5, 0.2, exact});
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 40; ++i) EXPECT_FALSE(find(lookup, 1.0 + i));
    // Waiting each time takes 20 s.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
    EXPECT_NE(note.find("no transform from camera to base"), std::string::npos) << note;
  }
}

TEST_F(TransformLookupTest, OneThatStopsHoldsUpOneFrameOnly) {
  hear(1.0);
  TransformLookup lookup(buffer, {0.5, 0.2, true});
  EXPECT_TRUE(find(lookup, 1.0));
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 40; ++i) EXPECT_FALSE(find(lookup, 2.0 + i));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(TransformLookupTest, LiveOneThatIsAlwaysLateIsNotWaitedForAgain) {
  hear(1.0);
  TransformLookup lookup(buffer, {30.0, 0.2, false});
  for (int i = 1; i < 10; ++i) {
    hear(1.0 + 0.1 * i);
    EXPECT_NEAR(find(lookup, 1.05 + 0.1 * i).value_or(0), 1.0 + 0.1 * i, 1e-9);
    EXPECT_NE(note.find("0.050 s older"), std::string::npos) << note;
  }
  EXPECT_FALSE(find(lookup, 3.0)) << "too old to stand in";
  EXPECT_NE(note.find("no transform"), std::string::npos) << note;
}

TEST_F(TransformLookupTest, TheFirstIsWaitedFor) {
  for (const bool exact : {false, true}) {
    tf2::BufferCore late;
    TransformLookup lookup(late, {30.0, 0.2, exact});
    std::thread sender([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      late.setTransform(mountAt(1.0), "test");
    });
    EXPECT_TRUE(lookup.find("base", "camera", ros::Time(1.0), note)) << note;
    EXPECT_EQ(note, "");
    sender.join();
  }
}

/// As above, but it comes while the lookup looks: never the newest instead of that of the stamp.
TEST_F(TransformLookupTest, OneThatComesMeanwhileIsNoOldOne) {
  constexpr int kRounds = 2000;
  std::atomic<int> asked{0};
  std::thread sender([&] {
    for (int i = 1; i <= kRounds; ++i) {
      while (asked < i) std::this_thread::yield();
      hear(i);
    }
  });
  for (int i = 1; i <= kRounds; ++i) {
    TransformLookup lookup(buffer, {30.0, 0.2, false});
    asked = i;
    EXPECT_NEAR(find(lookup, i).value_or(0), i, 1e-9) << note;
    EXPECT_EQ(note, "");
  }
  sender.join();
}

TEST_F(TransformLookupTest, ExactMeansThatOfTheStamp) {
  hear(1.0);
  TransformLookup lookup(buffer, {30.0, 0.2, true});
  std::thread sender([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    hear(1.1);
  });
  EXPECT_NEAR(find(lookup, 1.05).value_or(0), 1.05, 1e-9);
  sender.join();
}

/// What ROS means by the covariance, by experiment.
TEST(PoseCovariance, IsThatOfPosesDrawnAtRandom) {
  const Eigen::Isometry3d T_map_base =
      pf::expSe3((Vector6d() << 1, -2, 0.5, 0.4, -1.1, 2.0).finished());
  // A head camera 1.3 m above the base: its tilt is the base's position.
  const Eigen::Isometry3d T_base_camera =
      pf::expSe3((Vector6d() << 0.2, -0.1, 1.3, -1.2, 1.1, -1.3).finished());
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Matrix6d A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = 2e-3 * normal(random);
  A.bottomRows<3>() *= 3;
  const Matrix6d camera = A * A.transpose();
  constexpr int kSamples = 200000;
  Matrix6d sum = Matrix6d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    Vector6d z;
    for (int k = 0; k < z.size(); ++k) z[k] = normal(random);  // Eigen 3.3 has no begin()
    const Eigen::Isometry3d T =
        T_map_base * T_base_camera * pf::expSe3(A * z) * T_base_camera.inverse();
    Vector6d error;
    error.head<3>() = T.translation() - T_map_base.translation();
    error.tail<3>() = pf::logSo3(T.linear() * T_map_base.linear().transpose());
    sum += error * error.transpose();
  }
  const Matrix6d expected = sum / kSamples;
  const Matrix6d found = poseCovariance(T_map_base, T_base_camera, camera);
  EXPECT_LT((found - expected).norm(), 0.02 * expected.norm()) << found << "\n\n" << expected;
  // The lever is most of it here.
  EXPECT_GT((poseCovariance(T_map_base, Eigen::Isometry3d::Identity(), camera) - expected).norm(),
            0.5 * expected.norm());
}

}  // namespace
}  // namespace posefusion_ros

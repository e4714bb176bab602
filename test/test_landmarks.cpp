// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/landmarks.hpp"

#include <gtest/gtest.h>

#include <random>

#include "posefusion/core/se3.hpp"
#include "posefusion/tracking/sparse_motion.hpp"
#include "small_camera.hpp"

namespace pf {
namespace {

/// A camera that goes along a wall of corners, and what it sees of them.
class LandmarksTest : public ::testing::Test {
 protected:
  static constexpr double kWall_m = 2.0;

  /// Corners on the wall, `walking` of them moving sideways by themselves.
  LandmarksTest() : depth_m_(camera_.height, camera_.width, CV_32FC1, cv::Scalar(kWall_m)) {
    std::uniform_real_distribution<double> x(-0.6, 0.6), y(-0.5, 0.5);
    for (int i = 0; i < 100; ++i) points_.emplace_back(x(random_), y(random_), kWall_m);
  }

  static Eigen::Isometry3d poseAt(int frame) {
    return Eigen::Isometry3d(Eigen::Translation3d(0.002 * frame, 0, 0));
  }

  cv::Point2f seen(std::size_t i, int frame, int walking, double noise_px) {
    std::normal_distribution<double> noise(0.0, noise_px);
    Eigen::Vector3d p = points_[i];
    if (i < static_cast<std::size_t>(walking)) p.x() += 0.004 * frame;
    const Eigen::Vector2d pixel = camera_.project(poseAt(frame).inverse() * p);
    return {static_cast<float>(pixel.x() + noise(random_)),
            static_cast<float>(pixel.y() + noise(random_))};
  }

  /// The flow into a frame; call with rising numbers.
  SparseFlow flowTo(int frame, int walking, double noise_px) {
    SparseFlow flow;
    flow.from_ns = frame - 1;
    flow.to_ns = frame;
    if (last_.empty()) {
      for (std::size_t i = 0; i < points_.size(); ++i)
        last_.push_back(seen(i, 0, walking, noise_px));
    }
    for (std::size_t i = 0; i < points_.size(); ++i) {
      flow.ids.push_back(static_cast<std::uint32_t>(10 + i));
      flow.before.push_back(last_[i]);
      last_[i] = seen(i, frame, walking, noise_px);
      flow.after.push_back(last_[i]);
    }
    return flow;
  }

  void update(const SparseFlow& flow, int frame, bool accepted = true) {
    landmarks_.update(flow, {depth_m_, camera_}, poseAt(frame), accepted);
  }

  std::mt19937 random_{5};
  PinholeCamera camera_ = vga();
  cv::Mat depth_m_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<cv::Point2f> last_;
  Landmarks landmarks_;
};

TEST_F(LandmarksTest, StandWhereTheyWereSeen) {
  for (int k = 1; k <= 10; ++k) update(flowTo(k, 0, 0.0), k);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Landmark* landmark = landmarks_.find(static_cast<std::uint32_t>(10 + i));
    ASSERT_NE(landmark, nullptr);
    EXPECT_TRUE(landmark->isBelieved());
    EXPECT_LT((landmark->at - points_[i]).norm(), 1e-3);
  }
  EXPECT_EQ(landmarks_.find(9), nullptr);
  EXPECT_EQ(landmarks_.find(110), nullptr);
}

TEST_F(LandmarksTest, CornersOnAWalkingPersonAreRejected) {
  for (int k = 1; k <= 30; ++k) update(flowTo(k, 20, 0.2), k);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    EXPECT_EQ(landmarks_.find(static_cast<std::uint32_t>(10 + i))->isBelieved(), i >= 20) << i;
  }
}

TEST_F(LandmarksTest, ARejectedFrameMovesNone) {
  update(flowTo(1, 0, 0.0), 1);
  const Eigen::Vector3d before = landmarks_.find(10)->at;
  landmarks_.update(flowTo(2, 0, 0.0), {depth_m_, camera_}, poseAt(9), false);
  EXPECT_EQ(landmarks_.find(10)->at, before);
  landmarks_.update(flowTo(3, 0, 0.0), {depth_m_, camera_}, poseAt(4), true);
  EXPECT_NE(landmarks_.find(10)->at, before);
}

TEST_F(LandmarksTest, AreForgottenWithTheirCornersAndFollowACorrection) {
  SparseFlow flow = flowTo(1, 0, 0.0);
  update(flow, 1);
  const Eigen::Vector3d before = landmarks_.find(12)->at;
  const Eigen::Isometry3d T(Eigen::Translation3d(0.5, 0, 1));
  landmarks_.move(T);
  EXPECT_LT((landmarks_.find(12)->at - T * before).norm(), 1e-12);
  flow.ids.resize(1);
  flow.before.resize(1);
  flow.after.resize(1);
  update(flow, 1);
  EXPECT_NE(landmarks_.find(10), nullptr);
  EXPECT_EQ(landmarks_.find(12), nullptr);
}

TEST_F(LandmarksTest, HoldAMotionThatDriftsFromFrameToFrame) {
  // The same flows, summed up with and without landmarks: only the latter drifts.
  Landmarks none;
  Eigen::Isometry3d held = poseAt(0), alone = poseAt(0);
  const auto step = [&](const SparseFlow& flow, const Landmarks* landmarks,
                        const Eigen::Isometry3d& T) {
    const SparseMotion motion =
        estimateMotion(flow, {depth_m_, depth_m_, nullptr, landmarks, T}, camera_);
    EXPECT_TRUE(motion.found);
    return Eigen::Isometry3d(T * motion.T_before_after);
  };
  double drift_held = 0, drift_alone = 0;
  for (int k = 1; k <= 60; ++k) {
    const SparseFlow flow = flowTo(k, 0, 0.4);
    held = step(flow, &landmarks_, held);
    alone = step(flow, nullptr, alone);
    landmarks_.update(flow, {depth_m_, camera_}, held, true);
    drift_held = std::max(drift_held, (held.translation() - poseAt(k).translation()).norm());
    drift_alone = std::max(drift_alone, (alone.translation() - poseAt(k).translation()).norm());
  }
  EXPECT_LT(drift_held, 0.5 * drift_alone);
}

/// A floor 1.2 m below a level camera, as it is measured, in pictures of any size.
class CornerDepthTest : public ::testing::TestWithParam<int> {
 protected:
  CornerDepthTest() : depth_m_(camera_.height, camera_.width, CV_32FC1, cv::Scalar(0)) {
    for (int v = horizon(); v < camera_.height; ++v) {
      for (int u = 0; u < camera_.width; ++u) depth_m_.at<float>(v, u) = measured(floorAt(v));
    }
  }

  int horizon() const { return static_cast<int>(camera_.cy) + 1; }
  double floorAt(int v) const { return 1.2 * camera_.fy / (v - camera_.cy); }
  float measured(double z) {
    std::normal_distribution<double> noise(0.0, sensor_.sigma(static_cast<float>(z)));
    return z < 4.5 ? static_cast<float>(z + noise(random_)) : 0.0F;
  }
  int rowOf(double z) const { return static_cast<int>(camera_.cy + 1.2 * camera_.fy / z); }
  CornerDepth around(int u, int v) const {
    return depthAround(depth_m_, sensor_, {static_cast<float>(u), static_cast<float>(v)});
  }

  std::mt19937 random_{7};
  DepthSensor sensor_;
  PinholeCamera camera_ = vga().shrunk(640 / GetParam());
  cv::Mat depth_m_;
};

TEST_P(CornerDepthTest, IsThatOfTheFloorHoweverFlatItIsSeen) {
  for (const double z : {2.8, 3.4, 4.0}) {
    const int v = rowOf(z);
    for (int u = 10; u < camera_.width - 10; u += camera_.width / 20) {
      const CornerDepth found = around(u, v);
      EXPECT_FALSE(found.is_edge) << z;
      EXPECT_NEAR(found.z_m, floorAt(v), 1.5 * sensor_.sigma(static_cast<float>(z))) << z;
    }
  }
}

TEST_P(CornerDepthTest, IsNoneOnTheRimOfSomethingNearer) {
  const int u = camera_.width / 2, v = rowOf(3.0);
  depth_m_.colRange(0, u).setTo(2.0F);
  EXPECT_TRUE(around(u, v).is_edge);
  EXPECT_EQ(around(u, v).z_m, 0);
}

TEST_P(CornerDepthTest, IsNoneWithoutDepthAndIsNotExtrapolated) {
  const int u = camera_.width / 2, v = rowOf(3.0);
  EXPECT_EQ(around(u, 3).z_m, 0);
  EXPECT_FALSE(around(u, 3).is_edge) << "nothing there is no rim";
  depth_m_.colRange(u - 1, camera_.width).setTo(0.0F);  // one column is left of the surroundings
  EXPECT_EQ(around(u, v).z_m, 0);
}

INSTANTIATE_TEST_SUITE_P(Widths, CornerDepthTest, testing::Values(320, 640));

}  // namespace
}  // namespace pf

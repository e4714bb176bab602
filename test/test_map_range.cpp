// SPDX-License-Identifier: BSD-3-Clause
// Nothing depends on where in the map frame the camera is.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "posefusion/core/se3.hpp"
#include "posefusion/slam/loop_thread.hpp"
#include "posefusion/slam/mapper.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

constexpr int kMapped = 40, kWalked = 15, kCovered = 12, kAfter = 25;

const SimulatedSequence& room() { return exactBox<kMapped>(); }

/// Maps the room from a map that begins at `start_m`.
class Walk {
 public:
  explicit Walk(const Eigen::Vector3d& start_m)
      : mapper_(std::make_unique<Mapper>(config())),
        loops_(std::make_unique<LoopThread>(config(), AnswerTime::after_lag)) {
    T_map_start_.translation() = start_m;
    mapper_->reset(T_map_start_);
  }

  void see(int index, bool covered = false) {
    StaticFrame input;
    input.frame = room().frame(index).frame;
    input.frame.stamp_ns = stamp_ns_ += 33333333;
    if (covered) input.frame.depth.setTo(0);
    statuses.push_back(mapper_->process(input));
    loops_->serve(*mapper_);
  }

  /// Covers the camera, and uncovers it elsewhere.
  void carry() {
    for (int i = 0; i < kCovered; ++i) see(kMapped - 1, true);
    for (int i = 0; i < kAfter; ++i) see(kMapped / 3);
  }

  Eigen::Isometry3d poseFromStart(std::size_t i) const {
    return T_map_start_.inverse() * statuses[i].T_map_camera;
  }

  const Mapper& mapper() const { return *mapper_; }

  std::vector<FrameStatus> statuses;

 private:
  static Config config() {
    Config c;
    c.frame.shrink = 1;  // the images are small already
    return c;
  }

  std::unique_ptr<Mapper> mapper_;
  std::unique_ptr<LoopThread> loops_;
  Eigen::Isometry3d T_map_start_ = Eigen::Isometry3d::Identity();
  std::int64_t stamp_ns_ = 0;
};

void expectSame(const Walk& a, const Walk& b, double within_m, double within_deg = 0.05) {
  constexpr double kDegree = M_PI / 180;
  ASSERT_EQ(a.statuses.size(), b.statuses.size());
  for (std::size_t i = 0; i < a.statuses.size(); ++i) {
    const FrameStatus &one = a.statuses[i], &other = b.statuses[i];
    EXPECT_EQ(one.state, other.state) << i << other.detail;
    EXPECT_EQ(one.outcome, other.outcome) << i << other.detail;
    EXPECT_EQ(one.located, other.located) << i << other.detail;
    EXPECT_EQ(one.fragment, other.fragment) << i;
    const Eigen::Isometry3d off = a.poseFromStart(i).inverse() * b.poseFromStart(i);
    EXPECT_LT(off.translation().norm(), within_m) << i;
    EXPECT_LT(angleOf(off), within_deg * kDegree) << i;
  }
  EXPECT_EQ(a.mapper().map().frame(), b.mapper().map().frame()) << "frames fused";
  EXPECT_EQ(a.mapper().backEnd().trajectory().size(), b.mapper().backEnd().trajectory().size());
  EXPECT_EQ(a.mapper().backEnd().graph().keyframes().size(),
            b.mapper().backEnd().graph().keyframes().size());
}

Walk walked(const Eigen::Vector3d& start_m) {
  Walk walk(start_m);
  for (int i = 0; i < kWalked; ++i) walk.see(i);
  for (const FrameStatus& status : walk.statuses) {
    EXPECT_TRUE(status.located) << start_m.transpose() << ": " << status.detail;
    EXPECT_EQ(status.fragment, 0);
  }
  return walk;
}

TEST(MapRange, AMapIsTheSameWhereverItBegins) {
  const Walk home = walked({0, 0, 0});
  // The second and third would cross a border at 250 m.
  for (const Eigen::Vector3d& start_m :
       {Eigen::Vector3d(-300, 0, 0), Eigen::Vector3d(-249.99, 0, 0), Eigen::Vector3d(249.99, 0, 0),
        Eigen::Vector3d(300, 0, 0), Eigen::Vector3d(0, 700, 0), Eigen::Vector3d(1000, 0, 0)}) {
    SCOPED_TRACE(start_m.transpose());
    expectSame(home, walked(start_m), 1e-3);
  }
}

TEST(MapRange, EveryDirectionIsLikeEveryOther) {
  const Walk home = walked({0, 0, 0});
  for (int axis = 0; axis < 3; ++axis) {
    for (const double far_m : {300.0, -300.0, 3000.0, -3000.0}) {
      const Eigen::Vector3d start_m = far_m * Eigen::Vector3d::Unit(axis);
      SCOPED_TRACE(start_m.transpose());
      // A float is 0.12 mm off at 3 km.
      expectSame(home, walked(start_m), std::abs(far_m) > 1000 ? 3e-3 : 1e-3);
    }
  }
}

TEST(MapRange, ALostCameraIsFoundWhereverTheMapBegins) {
  std::vector<Walk> walks;
  for (const Eigen::Vector3d& start_m :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-300, 0, 0), Eigen::Vector3d(600, 0, 0)}) {
    walks.emplace_back(start_m);
    Walk& walk = walks.back();
    for (int i = 0; i < kMapped; ++i) walk.see(i);
    walk.carry();
    EXPECT_EQ(walk.statuses[kMapped + kCovered].state, TrackingState::lost) << start_m.transpose();
    EXPECT_TRUE(walk.statuses.back().located) << start_m.transpose();
    // The search draws the map from voxels, which lie otherwise in each.
    expectSame(walks.front(), walk, 5e-3, 0.2);
  }
}

}  // namespace
}  // namespace pf

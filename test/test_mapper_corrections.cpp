// SPDX-License-Identifier: BSD-3-Clause
// Corrections that are prepared while frames go on.
#include <tbb/global_control.h>

#include "mapper_scene.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/loop_thread.hpp"

namespace pf {
namespace {

constexpr int kBefore = 30, kMeanwhile = 12;

class MapperCorrectionsTest : public MapperTest {
 protected:
  static Config config() {
    Config c = MapperTest::config();
    c.graph.keyframe_distance_m = 0.03;
    return c;
  }

  static void run(Mapper& mapper, int first, int last) {
    for (int i = first; i < last; ++i) {
      ASSERT_EQ(mapper.process({room().frame(i).frame, cv::Mat(), {}}).outcome,
                FrameOutcome::fused);
    }
  }

  /// A loop from the first keyframe to the last, by which the way was longer.
  static LoopAnswer loopOf(const Mapper& mapper, double longer_m = 0.04) {
    const auto& keyframes = mapper.backEnd().graph().keyframes();
    EXPECT_GT(keyframes.size(), 2U);
    const Keyframe &from = keyframes.front(), &to = keyframes.back();
    LoopConstraint loop{from.id, to.id, from.T_map_camera.inverse() * to.T_map_camera,
                        1e-6 * Matrix6d::Identity()};
    loop.T_from_to.translation().x() += longer_m;
    LoopAnswer answer;
    answer.loops.push_back(loop);
    return answer;
  }

  static Eigen::Isometry3d lastPose(const Mapper& mapper) {
    return mapper.skip(0, FrameOutcome::located).T_map_camera;
  }
};

TEST_F(MapperCorrectionsTest, NothingMovesUntilItIsTakenInAndThenAllDoes) {
  Mapper mapper(config());
  run(mapper, 0, kBefore);
  mapper.take(loopOf(mapper));
  auto correction = mapper.takeCorrection();
  ASSERT_TRUE(correction);
  EXPECT_FALSE(mapper.takeCorrection()) << "one at a time";
  CorrectedMap corrected = prepare(std::move(*correction));
  const Eigen::Isometry3d before = lastPose(mapper);
  EXPECT_EQ(mapper.backEnd().graph().version(), 0);
  mapper.take(corrected);
  EXPECT_EQ(mapper.backEnd().graph().version(), 1);
  EXPECT_EQ(mapper.backEnd().counts().accepted, 1U);
  EXPECT_GT((lastPose(mapper).translation() - before.translation()).norm(), 0.02);
  EXPECT_FALSE(mapper.takeCorrection()) << "it is done";
}

TEST_F(MapperCorrectionsTest, WhatCameMeanwhileFollowsRigidly) {
  Mapper mapper(config());
  run(mapper, 0, kBefore);
  mapper.take(loopOf(mapper, 0.014));  // too little for layers: no surfel goes
  const std::int32_t last = mapper.backEnd().graph().keyframes().back().map_frame;
  auto correction = mapper.takeCorrection();
  ASSERT_TRUE(correction);
  run(mapper, kBefore, kBefore + kMeanwhile);
  ASSERT_GT(mapper.backEnd().graph().keyframes().back().map_frame, last) << "a keyframe too";
  const SurfelArrays before = mapper.map().collect();
  const Eigen::Isometry3d T_before = lastPose(mapper);
  CorrectedMap corrected = prepare(std::move(*correction));
  mapper.take(corrected);
  const SurfelArrays after = mapper.map().collect();
  const Eigen::Isometry3f T = (lastPose(mapper) * T_before.inverse()).cast<float>();
  ASSERT_GT(T.translation().norm(), 0.01);
  ASSERT_EQ(after.size(), before.size());
  std::size_t fresh = 0, old = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Eigen::Vector3f was(before.x[i], before.y[i], before.z[i]);
    const Eigen::Vector3f is(after.x[i], after.y[i], after.z[i]);
    if (before.created[i] >= last) {
      ++fresh;
      ASSERT_LT((T * was - is).norm(), 1e-5);
    } else if (before.created[i] == 0) {
      ++old;
      ASSERT_EQ(was, is) << "the first keyframe stays";
    }
  }
  EXPECT_GT(fresh, 20U);
  EXPECT_GT(old, 1000U);
  EXPECT_TRUE(mapper.view().T_map_camera.isApprox(lastPose(mapper), 1e-9));
  run(mapper, kBefore + kMeanwhile, kBefore + kMeanwhile + 5);  // the camera goes on in it
}

TEST_F(MapperCorrectionsTest, OneOfAMapThatIsGoneIsLeftOut) {
  Mapper mapper(config());
  run(mapper, 0, kBefore);
  mapper.take(loopOf(mapper));
  auto correction = mapper.takeCorrection();
  ASSERT_TRUE(correction);
  mapper.reset();
  run(mapper, kBefore, kBefore + 3);
  const SurfelArrays before = mapper.map().collect();
  CorrectedMap corrected = prepare(std::move(*correction));
  mapper.take(corrected);
  EXPECT_EQ(mapper.backEnd().graph().version(), 0);
  EXPECT_EQ(mapper.map().collect().x, before.x);
}

TEST_F(MapperCorrectionsTest, AMapThatMayNotChangeStays) {
  Mapper mapper(config());
  run(mapper, 0, kBefore);
  mapper.take(loopOf(mapper));
  auto correction = mapper.takeCorrection();
  ASSERT_TRUE(correction);
  mapper.setUse(MapUse::localize_only);
  CorrectedMap corrected = prepare(std::move(*correction));
  mapper.take(corrected);
  EXPECT_EQ(mapper.backEnd().graph().version(), 0);
  mapper.take(loopOf(mapper));
  EXPECT_FALSE(mapper.takeCorrection());
}

TEST_F(MapperCorrectionsTest, OneThatFailsMakesWayForTheNext) {
  Mapper mapper(config());
  LoopThread loops(config(), AnswerTime::after_lag);
  run(mapper, 0, kBefore);
  LoopAnswer wrong = loopOf(mapper);
  wrong.loops[0].covariance.setConstant(std::nan(""));
  mapper.take(wrong);
  loops.serve(mapper);
  EXPECT_THROW(loops.finish(mapper), std::exception);
  mapper.take(loopOf(mapper));
  EXPECT_TRUE(mapper.takeCorrection());
}

TEST_F(MapperCorrectionsTest, IsTheSameForAnyNumberOfThreads) {
  std::vector<SurfelArrays> maps;
  for (const int threads : {1, 4}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                              static_cast<std::size_t>(threads));
    Mapper mapper(config());
    LoopThread loops(config(), AnswerTime::after_lag);
    run(mapper, 0, kBefore);
    mapper.take(loopOf(mapper));
    for (int i = kBefore; i < kBefore + 20; ++i) {
      loops.serve(mapper);
      run(mapper, i, i + 1);
    }
    EXPECT_EQ(mapper.backEnd().counts().accepted, 1U);
    loops.finish(mapper);
    maps.push_back(mapper.map().collect());
  }
  maps[0].forEachArray(maps[1], [](const auto& a, const auto& b) { EXPECT_TRUE(a == b); });
}

}  // namespace
}  // namespace pf

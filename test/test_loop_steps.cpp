// SPDX-License-Identifier: BSD-3-Clause
// A keyframe's step by tracking, measured again by pictures beside the mapper.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <utility>

#include "posefusion/core/se3.hpp"
#include "posefusion/slam/mapper.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

constexpr int kFrames = 60;

const SimulatedSequence& room() { return exactBox<kFrames>(); }

Config configOfRoom() {
  Config config;
  config.frame.shrink = 1;  // the images are small already
  config.graph.keyframe_distance_m = 0.05;
  return config;
}

/// Of a camera without errors in an earlier recording.
DepthCalibration knownCamera() {
  DepthCalibration known;
  known.camera = room().frame(0).frame.camera;
  return known;
}

class LoopSteps : public testing::Test {
 protected:
  LoopSteps() { mapper.calibrate(knownCamera()); }

  const Config config = configOfRoom();
  Mapper mapper{config};
};

/// Maps frames until there is a question for a keyframe that was tracked from another.
std::optional<LoopQuestion> askedBy(Mapper& mapper, LoopWorker* worker = nullptr) {
  for (int i = 0; i < kFrames; ++i) {
    mapper.process({room().frame(i).frame, cv::Mat(), {}});
    auto question = mapper.takeQuestion();
    if (question && question->step) return question;
    if (question && worker != nullptr) worker->answer(*question);
  }
  return std::nullopt;
}

LoopAnswer answerWith(const LoopQuestion& question, const Eigen::Isometry3d& T_off) {
  LoopAnswer answer;
  answer.depth_version = question.depth_version;
  answer.step = question.step;
  answer.step->T_from_to = answer.step->T_from_to * T_off;
  return answer;
}

Eigen::Isometry3d aLittle() {
  Vector6d twist;
  twist << 0.004, -0.002, 0.003, 0.001, 0.002, -0.001;
  return expSe3(twist);
}

TEST_F(LoopSteps, PicturesCorrectTheStepsOfTracking) {
  LoopWorker worker(config.loop, config.tracking, depthSensorOf(config), config.calibration);
  std::optional<LoopQuestion> question = askedBy(mapper, &worker);
  ASSERT_TRUE(question);
  const Eigen::Isometry3d tracked = question->step->T_from_to;
  question->step->T_from_to = tracked * aLittle();
  const LoopAnswer answer = worker.answer(*question);
  ASSERT_TRUE(answer.step);
  EXPECT_EQ(answer.step->from, question->step->from);
  EXPECT_EQ(answer.step->to, question->step->to);
  EXPECT_EQ(answer.step->kind, ConstraintKind::odometry);
  // The room has no errors of a sensor: tracking is right there.
  EXPECT_LT(logSe3(tracked.inverse() * answer.step->T_from_to).norm(),
            0.3 * logSe3(aLittle()).norm());
}

TEST_F(LoopSteps, KeyframeMapAndCameraFollow) {
  const std::optional<LoopQuestion> question = askedBy(mapper);
  ASSERT_TRUE(question);
  const std::vector<MapPose> before = mapper.backEnd().keyframePoses();
  const Eigen::Isometry3d T_before = mapper.skip(0, FrameOutcome::located).T_map_camera;
  mapper.take(answerWith(*question, aLittle()));
  const std::vector<MapPose> after = mapper.backEnd().keyframePoses();
  EXPECT_EQ(after.front().T_map_camera.matrix(), before.front().T_map_camera.matrix());
  const Eigen::Isometry3d T_new_old =
      after.back().T_map_camera * before.back().T_map_camera.inverse();
  EXPECT_TRUE(after.back().T_map_camera.isApprox(before.back().T_map_camera * aLittle(), 1e-9));
  const Eigen::Isometry3d T_after = mapper.skip(0, FrameOutcome::located).T_map_camera;
  EXPECT_TRUE(T_after.isApprox(T_new_old * T_before, 1e-9));
}

TEST_F(LoopSteps, OfDepthAsItWasBeforeNothingIsTaken) {
  const std::optional<LoopQuestion> question = askedBy(mapper);
  ASSERT_TRUE(question);
  LoopAnswer answer = answerWith(*question, aLittle());
  ++answer.depth_version;
  const int version = mapper.backEnd().graph().version();
  mapper.take(answer);
  EXPECT_EQ(mapper.backEnd().graph().version(), version);
}

TEST_F(LoopSteps, AMapThatMayNotChangeStays) {
  const std::optional<LoopQuestion> question = askedBy(mapper);
  ASSERT_TRUE(question);
  mapper.setUse(MapUse::localize_only);
  const int version = mapper.backEnd().graph().version();
  mapper.take(answerWith(*question, aLittle()));
  EXPECT_EQ(mapper.backEnd().graph().version(), version);
}

TEST(LoopStepsOff, WithoutLoopsNoStepIsMeasured) {
  Config config = configOfRoom();
  config.loop.enabled = false;
  Mapper mapper(config);
  mapper.calibrate(knownCamera());
  EXPECT_FALSE(askedBy(mapper));
}

// Pictures of a camera with an unknown depth field measure turns worse than the map does.
TEST(LoopStepsOff, WithoutACalibrationNoStepIsMeasured) {
  Mapper mapper(configOfRoom());
  EXPECT_FALSE(askedBy(mapper));
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
// A mapper whose depth camera has systematic errors, known before or learned.
#include <gtest/gtest.h>

#include "calibration_room.hpp"
#include "mapper_scene.hpp"
#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {
namespace {

constexpr int kFrames = 12;

class MapperCalibrationTest : public MapperTest {
 protected:
  /// A frame as a camera sees it that is off by test::roomField().
  static StaticFrame seen(int index, bool is_off = true) {
    StaticFrame still;
    still.frame = room().frame(index).frame;
    if (is_off) {
      still.frame.depth = DepthCorrector(test::roomField().inverse())
                              .likeInput(still.frame.depth, still.frame.depth_unit_m);
    }
    return still;
  }

  static void run(Mapper& mapper, bool is_off = true) {
    for (int i = 0; i < kFrames; ++i) mapper.process(seen(i, is_off));
  }

  static DepthCalibration known() {
    DepthCalibration calibration;
    calibration.camera = room().frame(0).frame.camera;
    calibration.field = test::roomField();
    return calibration;
  }

  /// Mean distance (m) between what both maps show from one pose.
  static double apart_m(const Mapper& a, const Mapper& b) {
    const TrueFrame truth = room().frame(3);
    const cv::Mat of_a = a.render(truth.frame.camera, truth.T_map_camera).depth_m;
    const cv::Mat of_b = b.render(truth.frame.camera, truth.T_map_camera).depth_m;
    const cv::Mat both = (of_a > 0) & (of_b > 0);
    cv::Mat difference;
    cv::absdiff(of_a, of_b, difference);
    EXPECT_GT(cv::countNonZero(both), both.total() / 2);
    return cv::mean(difference, both)[0];
  }

  static LoopAnswer learned(const Mapper& mapper) {
    LoopAnswer answer;
    answer.calibration = known();
    answer.depth_version = mapper.depthVersion();
    return answer;
  }
};

TEST_F(MapperCalibrationTest, AKnownFieldMakesTheMapOfACameraThatIsNotOff) {
  Mapper straight(config()), corrected(config()), bent(config());
  corrected.calibrate(known());
  run(straight, false);
  run(corrected);
  run(bent);
  EXPECT_GT(apart_m(bent, straight), 0.004);
  EXPECT_LT(apart_m(corrected, straight), 0.0015);
}

TEST_F(MapperCalibrationTest, TheViewForTheSegmenterIsAsTheCameraMeasures) {
  Mapper corrected(config());
  corrected.calibrate(known());
  run(corrected);
  const ModelView& view = corrected.view();
  const cv::Mat drawn = corrected.render(view.camera, view.T_map_camera).depth_m;
  const cv::Mat wanted = DepthCorrector(test::roomField().inverse()).inMetres(drawn, 1.0);
  cv::Mat difference;
  cv::absdiff(view.depth_m, wanted, difference);
  const cv::Mat both = (view.depth_m > 0) & (wanted > 0);
  EXPECT_GT(cv::countNonZero(both), 0.8 * static_cast<double>(both.total()));
  EXPECT_LT(cv::mean(difference, both)[0], 1e-4);
  EXPECT_GT(cv::norm(drawn, wanted, cv::NORM_INF), 0.02);
}

TEST_F(MapperCalibrationTest, WhatIsLearnedComesIntoTheMapItsKeyframesAndTheFramesAfterIt) {
  Mapper straight(config()), learns(config());
  run(straight, false);
  run(learns);
  const double before_m = apart_m(learns, straight);
  const cv::Mat picture = learns.keyframeViews().front().depth_mm.clone();
  const int corrections = learns.backEnd().graph().version();
  learns.take(learned(learns));
  EXPECT_EQ(learns.depthVersion(), 0) << "what it wants of the map is still to be prepared";
  learns.settle();
  EXPECT_EQ(learns.depthVersion(), 1);
  EXPECT_EQ(learns.backEnd().graph().version(), corrections + 1);
  EXPECT_LT(apart_m(learns, straight), 0.4 * before_m);
  EXPECT_GT(cv::norm(picture, learns.keyframeViews().front().depth_mm, cv::NORM_INF), 5);
  const auto question = learns.takeQuestion();
  ASSERT_TRUE(question && question->known) << "the closer gets the corrected pictures";
  EXPECT_EQ(question->known->size(), learns.keyframeViews().size());
  EXPECT_EQ(learns.process(seen(kFrames)).outcome, FrameOutcome::fused);
}

TEST_F(MapperCalibrationTest, WhatWasLearnedOfDepthAsItWasBeforeIsNotTakenTwice) {
  Mapper mapper(config());
  run(mapper);
  const LoopAnswer answer = learned(mapper);
  mapper.take(answer);
  mapper.settle();
  const SurfelArrays once = mapper.map().collect();
  mapper.take(answer);
  mapper.settle();
  EXPECT_EQ(mapper.depthVersion(), 1);
  EXPECT_EQ(mapper.map().collect().z, once.z);
}

TEST_F(MapperCalibrationTest, ASavedMapBringsItsCalibrationOrIsCorrectedByTheOneGiven) {
  Mapper corrected(config());
  corrected.calibrate(known());
  run(corrected);
  Mapper again(config());
  again.load(corrected.saved(room().frame(0).frame.camera), MapUse::extend);
  ASSERT_TRUE(again.calibration());
  EXPECT_EQ(again.calibration()->field.nodes(), known().field.nodes());
  EXPECT_EQ(again.map().size(), corrected.map().size());
  EXPECT_LT(apart_m(again, corrected), 1e-5) << "corrected once, not twice";

  Mapper straight(config()), bent(config()), mended(config());
  run(straight, false);
  run(bent);
  mended.calibrate(known());
  mended.load(bent.saved(room().frame(0).frame.camera), MapUse::extend);
  EXPECT_LT(apart_m(mended, straight), 0.4 * apart_m(bent, straight));
  EXPECT_EQ(mended.depthVersion(), 1) << "its pictures are to be written anew";
}

TEST_F(MapperCalibrationTest, OfTheSensorsErrorOnlyWhatIsLeftIsReckonedWith) {
  const auto covariance = [](double left_per_m) {
    Mapper mapper(config());
    DepthCalibration calibration = known();
    calibration.left_per_m = left_per_m;
    mapper.calibrate(calibration);
    FrameStatus status;
    for (int i = 0; i < kFrames; ++i) status = mapper.process(seen(i));
    return status.covariance.trace();
  };
  const double unknown = covariance(0.0), much = covariance(0.1), little = covariance(0.0002);
  EXPECT_LT(little, 0.8 * unknown);
  EXPECT_EQ(much, unknown) << "never more than an uncalibrated camera has";
}

TEST_F(MapperCalibrationTest, SettingsLimitWhatIsDone) {
  Config none = config();
  none.calibration.mode = "none";
  Mapper mapper(none);
  EXPECT_THROW(mapper.calibrate(known()), InputError);
  EXPECT_NE(mapper.askForCalibration(), "");
  Mapper corrected(config());
  EXPECT_NE(corrected.askForCalibration().find("no map"), std::string::npos);
  corrected.calibrate(known());
  run(corrected);
  EXPECT_EQ(corrected.askForCalibration(), "");
  EXPECT_THROW(mapper.load(corrected.saved(room().frame(0).frame.camera), MapUse::extend),
               InputError);
}

TEST_F(MapperCalibrationTest, FramesOfAnotherViewAreRefused) {
  Mapper mapper(config());
  DepthCalibration other = known();
  other.camera.fx *= 1.5;
  mapper.calibrate(other);
  const FrameStatus status = mapper.process(seen(0));
  EXPECT_EQ(status.outcome, FrameOutcome::bad_input);
  EXPECT_NE(status.detail.find("another view"), std::string::npos) << status.detail;
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/localiser.hpp"

#include <stdexcept>

#include "mapper_scene.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

/// A camera in the mapped room that is lost and comes back.
class MapperReturnTest : public MapperTest {
 protected:
  void SetUp() override {
    for (int i = 0; i < 20; ++i) see(room().frame(i).frame);
  }
  void see(RgbdFrame frame, bool forced = false) {
    frame.stamp_ns = stamp_ns_ += 33333333;
    StaticFrame input{frame, {}, {}};
    input.forced = forced;
    status_ = mapper_.process(input);
  }
  /// Covers the camera until it is lost, not a frame longer.
  void lose() {
    const cv::Mat nothing = cv::Mat::zeros(240, 320, CV_16UC1);
    for (int i = 0; i < 20 && !isLost(); ++i) see(withDepth(truth_, nothing));
    ASSERT_TRUE(isLost());
  }
  /// Covers it too briefly to be lost.
  void cover(int frames) {
    const cv::Mat nothing = cv::Mat::zeros(240, 320, CV_16UC1);
    for (int i = 0; i < frames; ++i) see(withDepth(truth_, nothing));
    ASSERT_EQ(status_.state, TrackingState::doubtful);
  }
  /// Of the same shape.
  RgbdFrame anotherPicture() const { return anotherPicture(truth_); }
  static RgbdFrame anotherPicture(const TrueFrame& from) {
    RgbdFrame frame = from.frame;
    frame.color = cv::Mat(cv::Scalar::all(255) - from.frame.color);  // pixels of its own
    return frame;
  }
  /// Of the same shape, with half the contrast below much noise.
  static RgbdFrame poorPicture(const TrueFrame& from) {
    RgbdFrame frame = from.frame;
    cv::Mat noise(from.frame.color.size(), CV_8UC3);
    cv::RNG(3).fill(noise, cv::RNG::UNIFORM, 0, 60);
    frame.color = 0.5 * from.frame.color + noise;
    return frame;
  }
  /// The first frame so far from the last known pose.
  TrueFrame firstBeyond(double way_m) const {
    for (int i = 20; i < 60; ++i) {
      if (errorM(status_, room().frame(i)) > way_m) return room().frame(i);
    }
    throw std::logic_error("the camera does not move so far");
  }
  /// The loop closer's answer: the place where the camera is.
  void answerPlace() {
    LoopAnswer answer;
    answer.asked_for_place = true;
    answer.place.emplace();
    answer.place->doubt = PlaceDoubt::none;
    answer.place->log_odds = 10;
    answer.place->alignment.T_map_camera = truth_.T_map_camera;
    mapper_.take(answer);
  }
  bool isLost() const { return status_.state == TrackingState::lost; }
  void expectNeverBackWithAnotherPicture() {
    for (int k = 0; k < 24; ++k) {
      see(anotherPicture());
      ASSERT_TRUE(isLost()) << k;
    }
  }

  Mapper mapper_{config()};
  FrameStatus status_;
  std::int64_t stamp_ns_ = 0;
  const TrueFrame truth_ = room().frame(20);
};

TEST_F(MapperReturnTest, NotWhereShapeFitsButThePictureIsAnother) {
  lose();
  expectNeverBackWithAnotherPicture();
}

TEST_F(MapperReturnTest, AfterAGapItIsBackWhereAllFits) {
  cover(7);
  see(truth_.frame);
  EXPECT_EQ(status_.state, TrackingState::tracking) << status_.detail;
}

TEST_F(MapperReturnTest, AfterAGapTheShapeIsNotEnough) {
  cover(7);
  see(anotherPicture());
  EXPECT_EQ(status_.outcome, FrameOutcome::jumped) << status_.detail;
}

TEST_F(MapperReturnTest, WithoutAGapAPoorPictureIsEnough) {
  cover(2);
  see(poorPicture(truth_));
  EXPECT_EQ(status_.state, TrackingState::tracking) << status_.detail;
}

TEST_F(MapperReturnTest, WhereNoCornerMeasuresAStepAPoorPictureIsEnough) {
  const TrueFrame away = firstBeyond(0.08);
  see(poorPicture(away));
  EXPECT_EQ(status_.state, TrackingState::tracking) << status_.detail;
  EXPECT_LT(errorM(status_, away), 0.01);
}

TEST_F(MapperReturnTest, FarFromWhereItWasSeenLastTheShapeIsNotEnough) {
  cover(2);
  const TrueFrame far = firstBeyond(0.16);
  see(anotherPicture(far));
  EXPECT_EQ(status_.outcome, FrameOutcome::jumped) << status_.detail;
  see(far.frame);
  EXPECT_EQ(status_.state, TrackingState::tracking) << status_.detail;
  EXPECT_LT(errorM(status_, far), 0.01);
}

TEST_F(MapperReturnTest, ABlurredFrameFarFromWhereItWasSeenLastIsNotAcceptedByShape) {
  const TrueFrame near = firstBeyond(0.08);
  see(anotherPicture(near), true);
  EXPECT_EQ(status_.outcome, FrameOutcome::forced) << status_.detail;
  EXPECT_TRUE(status_.located) << "as in a turn";
  const TrueFrame far = firstBeyond(0.16);
  see(anotherPicture(far), true);
  EXPECT_EQ(status_.outcome, FrameOutcome::disagrees) << status_.detail;
  EXPECT_FALSE(status_.located) << "as in a fall";
}

TEST_F(MapperReturnTest, APlaceThatWasFoundDoesNotCountForTheNextLoss) {
  lose();
  see(truth_.frame);
  answerPlace();
  for (int k = 0; k < 6; ++k) see(truth_.frame);
  ASSERT_FALSE(isLost());
  lose();
  expectNeverBackWithAnotherPicture();
}

TEST_F(MapperReturnTest, APlaceThatWasFoundComesBeforeWhatOnlyLooksRight) {
  lose();
  for (int k = 0; k < 4; ++k) see(truth_.frame);
  ASSERT_EQ(status_.outcome, FrameOutcome::unproven) << "it looks right, and is being proven";
  answerPlace();
  for (int k = 0; k < 6; ++k) see(truth_.frame);
  EXPECT_EQ(status_.state, TrackingState::tracking) << "six frames are enough where it was found";
  EXPECT_LT(errorM(status_, truth_), 0.006);
}

}  // namespace
}  // namespace pf

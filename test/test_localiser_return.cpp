// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/localiser.hpp"

#include <cmath>
#include <stdexcept>

#include "fusion_scene.hpp"
#include "mapper_scene.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/map/fusion.hpp"
#include "posefusion/map/render.hpp"

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
  /// Not for so long that it is lost.
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
  /// The first frame that the camera took so far from where it was seen last.
  TrueFrame firstBeyond(double way_m) const {
    for (int i = 20; i < 60; ++i) {
      if (errorM(status_, room().frame(i)) > way_m) return room().frame(i);
    }
    throw std::logic_error("the camera does not move so far");
  }
  /// The loop closer has seen that the camera is where it is.
  void tellPlace() {
    LoopAnswer answer;
    answer.asked_for_place = true;
    answer.place.emplace();
    answer.place->doubt = PlaceDoubt::none;
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
  EXPECT_EQ(status_.outcome, FrameOutcome::disagrees) << status_.detail;
}

TEST_F(MapperReturnTest, WithoutAGapTheShapeIsEnough) {
  cover(2);
  see(anotherPicture());
  EXPECT_EQ(status_.state, TrackingState::tracking) << status_.detail;
}

TEST_F(MapperReturnTest, WhereNoCornerTellsOfAStepShapeIsEnough) {
  const TrueFrame away = firstBeyond(0.08);
  see(anotherPicture(away));
  EXPECT_EQ(status_.state, TrackingState::tracking) << status_.detail;
  EXPECT_LT(errorM(status_, away), 0.01);
}

TEST_F(MapperReturnTest, FarFromWhereItWasSeenLastTheShapeIsNotEnough) {
  cover(2);
  const TrueFrame far = firstBeyond(0.16);
  see(anotherPicture(far));
  EXPECT_EQ(status_.outcome, FrameOutcome::disagrees) << status_.detail;
  see(far.frame);
  EXPECT_EQ(status_.state, TrackingState::tracking) << status_.detail;
  EXPECT_LT(errorM(status_, far), 0.01);
}

TEST_F(MapperReturnTest, ABlurredFrameFarFromWhereItWasSeenLastIsNotToldByShape) {
  const TrueFrame near = firstBeyond(0.08);
  see(anotherPicture(near), true);
  EXPECT_EQ(status_.outcome, FrameOutcome::forced) << status_.detail;
  EXPECT_TRUE(status_.located) << "as in a turn";
  const TrueFrame far = firstBeyond(0.16);
  see(anotherPicture(far), true);
  EXPECT_EQ(status_.outcome, FrameOutcome::disagrees) << status_.detail;
  EXPECT_FALSE(status_.located) << "as in a fall";
}

TEST_F(MapperReturnTest, APlaceThatWasFoundSaysNothingOfTheNextLoss) {
  lose();
  see(truth_.frame);
  tellPlace();
  for (int k = 0; k < 3; ++k) see(truth_.frame);
  ASSERT_FALSE(isLost());
  lose();
  expectNeverBackWithAnotherPicture();
}

TEST_F(MapperReturnTest, APlaceThatWasFoundComesBeforeWhatOnlyLooksRight) {
  lose();
  for (int k = 0; k < 4; ++k) see(truth_.frame);
  ASSERT_EQ(status_.outcome, FrameOutcome::unproven) << "it looks right, and is being proven";
  tellPlace();
  for (int k = 0; k < 3; ++k) see(truth_.frame);
  EXPECT_EQ(status_.state, TrackingState::tracking) << "three frames are enough where it was found";
  EXPECT_LT(errorM(status_, truth_), 0.006);
}

/// A step of a camera in a mapped room that no corner tells of.
class LocaliserStepTest : public MapperTest {
 protected:
  void SetUp() override {
    Fuser fuser;
    for (int i = 0; i <= kFirst; ++i) fuser.fuse(frameAt(i), room().frame(i).T_map_camera, map_);
    localiser_.begin(frameAt(kFirst), room().frame(kFirst).frame.stamp_ns,
                     room().frame(kFirst).T_map_camera);
  }
  const WorkingFrame& frameAt(int i) {
    frame_.assign(room().frame(i).frame, cv::Mat(), config().frame);
    return frame_;
  }
  const ModelView& viewFrom(const Eigen::Isometry3d& T) {
    SurfelRenderer().render(map_, frame_.camera, T, {}, view_);
    return view_;
  }
  /// Some frames on; `shows`: depth of the map as the strict test sees it, times this.
  Location step(double shows, const SparseFlow& flow = {}, bool forced = false) {
    const WorkingFrame& frame = frameAt(kFirst + kStep);
    MapRenderers render;
    render.model = [this](const Eigen::Isometry3d& T) {
      points_.assign(viewFrom(T));
      return RenderedModel{points_, T};
    };
    render.view = [this, shows](const Eigen::Isometry3d& T) -> const ModelView& {
      viewFrom(T);
      view_.depth_m *= shows;
      return view_;
    };
    return localiser_.locate(frame, room().frame(kFirst + kStep).frame.stamp_ns, flow, forced,
                             view_, render);
  }
  /// The corners' way from the first frame into another one, as if that were the next.
  static SparseFlow flowTo(int i) {
    FlowTracker tracker;
    tracker.advance(room().frame(kFirst).frame);
    RgbdFrame next = room().frame(i).frame;
    next.stamp_ns = room().frame(kFirst + kStep).frame.stamp_ns;
    return tracker.advance(next);
  }

  static constexpr int kFirst = 20, kStep = 8;
  SurfelMap map_{config().map};
  Localiser localiser_{config().tracking};
  WorkingFrame frame_;
  ModelView view_;
  ModelPyramid points_;
};

TEST_F(LocaliserStepTest, IsBelievedWhereTheMapShowsTheSame) {
  const Location location = step(1.0);
  EXPECT_EQ(location.outcome, FrameOutcome::fused) << location.detail;
}

TEST_F(LocaliserStepTest, IsNotBelievedByWhatTrackingAloneSays) {
  const Location location = step(1.5);
  EXPECT_EQ(location.outcome, FrameOutcome::disagrees) << location.detail;
}

TEST_F(LocaliserStepTest, OfABlurredFrameIsToldWhereCornersDoNotContradict) {
  const Localiser before = localiser_;
  const Location location = step(1.0, flowTo(kFirst + kStep), true);
  ASSERT_TRUE(location.motion.found);
  EXPECT_EQ(location.outcome, FrameOutcome::forced);
  EXPECT_TRUE(location.located);
  localiser_ = before;
  const Location contradicted = step(1.0, flowTo(kFirst), true);
  ASSERT_TRUE(contradicted.motion.found);
  EXPECT_FALSE(contradicted.located) << "corners say that it stands still";
}

/// A camera in a room of which the map shows nothing any more.
class LocaliserLossTest : public MapperTest {
 protected:
  Location see(int i, const SparseFlow& flow) {
    const TrueFrame truth = room().frame(i);
    frame_.assign(truth.frame, cv::Mat(), config().frame);
    if (i == 0) return localiser_.begin(frame_, truth.frame.stamp_ns, truth.T_map_camera);
    return localiser_.locate(
        frame_, truth.frame.stamp_ns, flow, false, nothing_,
        {[&](const Eigen::Isometry3d& T) {
           return RenderedModel{points_, T};
         },
         [&](const Eigen::Isometry3d&) -> const ModelView& { return nothing_; }});
  }

  Localiser localiser_{config().tracking};
  WorkingFrame frame_;
  ModelView nothing_;
  ModelPyramid points_;
};

TEST_F(LocaliserLossTest, TheWayThroughALossIsKnownWhileCornersTellOfIt) {
  FlowTracker flow;
  Location location;
  constexpr int kLast = 24;
  for (int i = 0; i <= kLast; ++i) location = see(i, flow.advance(room().frame(i).frame));
  ASSERT_EQ(location.state, TrackingState::lost);
  EXPECT_TRUE(location.carried.is_measured);
  const Eigen::Isometry3d truth = room().frame(kLast).T_map_camera;
  const Eigen::Isometry3d off = truth.inverse() * location.carried.T_map_camera;
  EXPECT_LT(off.translation().norm(), 0.03);
  EXPECT_LT(angleOf(off), 0.02);
  const double sigma_m = std::sqrt(location.carried.covariance.topLeftCorner<3, 3>().trace());
  EXPECT_LT(off.translation().norm(), 3 * sigma_m) << "the covariance is honest";

  EXPECT_FALSE(see(kLast + 1, {}).carried.is_measured);
  location = see(kLast + 2, flow.advance(room().frame(kLast + 2).frame));
  EXPECT_FALSE(location.carried.is_measured) << "one step that nobody knows is enough";
}

/// A camera that stands before a wall without a picture, of which people leave a part, and a few
/// corners that are new in every frame: along the wall it is known by them alone.
class LocaliserGapTest : public ::testing::Test {
 protected:
  /// So many frames; ends with the first that is not believed.
  Location look(int frames, const cv::Rect& gap) {
    RgbdFrame frame{0, cv::Mat(120, 160, CV_8UC3, cv::Scalar(90, 90, 90)),
                    cv::Mat::zeros(120, 160, CV_32FC1), 1e-3, smallCamera()};
    frame.depth(gap).setTo(2.0F);
    frame_.assign(frame, cv::Mat(), fullResolution());
    fuseOften(20, frame_, map_);
    Location location = localiser_.begin(frame_, 0, kIdentity);
    for (int i = 1; i <= frames && location.outcome == FrameOutcome::fused; ++i) {
      location = see(i, gap);
    }
    return location;
  }
  Location see(int i, const cv::Rect& gap) {
    SparseFlow flow{kStep_ns * (i - 1), kStep_ns * i, {}, {}, {}};
    for (int k = 0; k < kCorners; ++k) {
      flow.before.emplace_back(gap.x + 3 + (k * 7) % (gap.width - 6),
                               gap.y + 3 + (k * 11) % (gap.height - 6));
      flow.ids.push_back(static_cast<std::uint32_t>(kCorners * i + k));
    }
    flow.after = flow.before;
    SurfelRenderer().render(map_, frame_.camera, kIdentity, {}, view_);
    points_.assign(view_);
    return localiser_.locate(frame_, flow.to_ns, flow, false, view_,
                             {[&](const Eigen::Isometry3d&) {
                                return RenderedModel{points_, kIdentity};
                              },
                              [&](const Eigen::Isometry3d&) -> const ModelView& { return view_; }});
  }

  static constexpr int kCorners = 14, kFrames = 300;
  static constexpr std::int64_t kStep_ns = 33333333;
  SurfelMap map_{MapConfig()};
  Localiser localiser_{TrackingConfig()};
  WorkingFrame frame_;
  ModelView view_;
  ModelPyramid points_;
};

TEST_F(LocaliserGapTest, IsNotBelievedWhereItIsKnownByALongChainOfCornersAlone) {
  const Location location = look(kFrames, {40, 20, 70, 80});
  EXPECT_EQ(location.outcome, FrameOutcome::degenerate) << location.detail;
  EXPECT_NE(location.detail.find("0.03"), std::string::npos) << location.detail;
}

TEST_F(LocaliserGapTest, AnOpenViewIsBelieved) {
  const Location location = look(kFrames, {0, 0, 160, 120});
  EXPECT_EQ(location.outcome, FrameOutcome::fused) << location.detail;
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/closer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/loop/worker.hpp"
#include "simulated_sequence.hpp"

namespace pf {
namespace {

constexpr int kViews = 4, kStep = 5;

const SimulatedSequence& closerRoom() {
  static const SimulatedSequence sequence("empty_box", kViews * kStep);
  return sequence;
}

WorkingFrame frameOf(int view) {
  WorkingFrame frame;
  FrameConfig config;
  config.shrink = 2;  // steps are a large part of the view: coarse on purpose
  frame.assign(closerRoom().frame(view * kStep).frame, cv::Mat(), config);
  return frame;
}

Eigen::Isometry3d poseOf(int view) { return closerRoom().pose(view * kStep); }

KeyframePicture pictureOf(int view) {
  KeyframePicture picture;
  picture.assign(keyframeView(frameOf(view), view, {0, poseOf(view)}, true), DepthSensor{});
  return picture;
}

LoopConfig quick() {
  LoopConfig config;
  config.min_gap_keyframes = 2;
  return config;
}

/// All views and then the first again; `off` is the error of the later poses.
std::vector<LoopConstraint> comeBack(LoopCloser& closer, const Eigen::Isometry3d& off) {
  for (int i = 0; i < kViews; ++i) {
    closer.addKeyframe(keyframeView(frameOf(i), i, {0, poseOf(i)}, true));
  }
  closer.addKeyframe(keyframeView(frameOf(0), kViews, {0, poseOf(0) * off}, true));
  return closer.findLoops();
}

TEST(KeyframePair, SeenFromItsOwnPoseAViewIsItself) {
  const ModelView view = pictureOf(0).model;
  ModelView same;
  seenFrom(view, Eigen::Isometry3d::Identity(), same);
  EXPECT_LT(cv::norm(view.depth_m, same.depth_m, cv::NORM_INF), 1e-5);
  EXPECT_EQ(cv::norm(view.intensity, same.intensity, cv::NORM_INF, view.depth_m > 0), 0);
}

TEST(KeyframePair, AlignsToTheTruth) {
  const Eigen::Isometry3d truth = poseOf(0).inverse() * poseOf(kViews - 1);
  PairAligner aligner{TrackingConfig{}};
  const PlaceVerdict verdict =
      aligner.align(pictureOf(0), pictureOf(kViews - 1), Eigen::Isometry3d::Identity());
  EXPECT_TRUE(verdict.accepted()) << name(verdict.doubt);
  const Eigen::Isometry3d off = truth.inverse() * verdict.alignment.T_map_camera;
  EXPECT_LT(off.translation().norm(), 0.03);
  EXPECT_LT(logSo3(off.linear()).norm(), 0.02);
}

TEST(KeyframePicture, KeepsTheDepthThatIsUsed) {
  KeyframeView view = keyframeView(frameOf(0), 0, {}, true);
  view.depth_mm.setTo(7000);
  const auto seenWith = [&](double max_depth_m) {
    DepthSensor sensor;
    sensor.max_depth_m = max_depth_m;
    KeyframePicture picture;
    picture.assign(view, sensor);
    return picture.frame.valid_pixels;
  };
  EXPECT_EQ(seenWith(5.0), 0);
  EXPECT_EQ(seenWith(9.0), static_cast<int>(view.depth_mm.total()));
}

TEST(LoopCloser, FernsDistinguishDepthsInTheWholeRange) {
  LoopConfig config = quick();
  const auto unlike = [&](double max_depth_m, double z_m) {
    DepthSensor sensor;
    sensor.max_depth_m = max_depth_m;
    LoopCloser closer(config, TrackingConfig{}, sensor);
    KeyframeView view = keyframeView(frameOf(0), 0, {}, true);
    const auto codeAt = [&](double depth_m) {
      view.thumbnail.depth_m.setTo(depth_m);
      return closer.ferns().encode(view.thumbnail);
    };
    return FernDatabase::dissimilarity(codeAt(z_m), codeAt(z_m + 1.5));
  };
  EXPECT_EQ(unlike(5.0, 6.0), 0.0);
  EXPECT_GT(unlike(9.0, 6.0), 0.1);
}

TEST(LoopCloser, ComingBackGivesTrueConstraints) {
  LoopCloser closer(quick(), TrackingConfig{}, DepthSensor{});
  Vector6d drift;
  drift << 0.1, 0.05, -0.08, 0.05, 0.08, 0.02;
  const auto loops = comeBack(closer, expSe3(drift));
  ASSERT_FALSE(loops.empty());
  for (const LoopConstraint& loop : loops) {
    EXPECT_EQ(loop.to, kViews);
    EXPECT_LE(loop.from, kViews - 2);
    const Eigen::Isometry3d truth = poseOf(static_cast<int>(loop.from)).inverse() * poseOf(0);
    const Eigen::Isometry3d off = truth.inverse() * loop.T_from_to;
    EXPECT_LT(off.translation().norm(), 0.05) << loop.from;
    EXPECT_LT(logSo3(off.linear()).norm(), 0.03) << loop.from;
    EXPECT_GT(loop.covariance.diagonal().minCoeff(), 0);
  }
  const LoopCounts& c = closer.counts();
  EXPECT_EQ(c.accepted, loops.size());
  EXPECT_EQ(c.accepted + c.allRefused(), c.compared);
  EXPECT_GT(c.local, 0U);
  EXPECT_LE(c.local, c.accepted);
}

TEST(LoopWorker, CountsGoOnWhereKeyframesAreSentAnew) {
  LoopWorker worker(quick(), TrackingConfig{}, DepthSensor{});
  std::vector<KeyframeView> views;
  LoopAnswer last;
  const auto add = [&](int id) {
    views.push_back(keyframeView(frameOf(0), id, {0, poseOf(0)}, true));
    LoopQuestion question;
    question.keyframe = views.back();
    return worker.answer(question);
  };
  for (int i = 0; i < 5; ++i) last = add(i);
  ASSERT_GT(last.counts.accepted, 0U);
  LoopQuestion anew;  // as after the camera's field was learned
  anew.known = views;
  const LoopCounts after = worker.answer(anew).counts;
  EXPECT_EQ(after.accepted, last.counts.accepted);
  EXPECT_EQ(after.compared, last.counts.compared);
  EXPECT_EQ(after.keyframes, views.size());
  EXPECT_GT(add(5).counts.compared, last.counts.compared);
  views.clear();
  EXPECT_EQ(add(0).counts.compared, 0U) << "a new map";
}

TEST(LoopCloser, FarByItsPoseAPlaceIsFoundByItsPicture) {
  LoopCloser closer(quick(), TrackingConfig{}, DepthSensor{});
  Eigen::Isometry3d drift = Eigen::Isometry3d::Identity();
  drift.translation().x() = 2 * quick().near_m;
  const auto loops = comeBack(closer, drift);
  ASSERT_FALSE(loops.empty());
  EXPECT_EQ(loops[0].from, 0);
  EXPECT_LT((loops[0].T_from_to.translation()).norm(), 0.02);
  EXPECT_EQ(closer.counts().accepted, loops.size());
  EXPECT_EQ(closer.counts().local, 0U);
}

TEST(LoopCloser, ComparesNoMoreThanIsEnough) {
  LoopConfig config = quick();
  config.enough_loops = 1;
  LoopCloser closer(config, TrackingConfig{}, DepthSensor{});
  const auto loops = comeBack(closer, Eigen::Isometry3d::Identity());
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0].from, 0) << "the nearest is the same picture";
  EXPECT_EQ(closer.counts().compared, 1U);
}

TEST(LoopCloser, PosesInOtherFragmentsAreNotNear) {
  // The coordinates are those of one place; only the pictures may confirm it.
  for (const int fragment : {0, 1}) {
    LoopCloser closer(quick(), TrackingConfig{}, DepthSensor{});
    for (int i = 0; i < kViews; ++i) {
      closer.addKeyframe(keyframeView(frameOf(i), i, {0, poseOf(i)}, true));
    }
    closer.addKeyframe(keyframeView(frameOf(0), kViews, {fragment, poseOf(0)}, true));
    closer.findLoops();
    EXPECT_EQ(closer.counts().local > 0, fragment == 0);
    std::vector<MapPose> poses = closer.poses();
    EXPECT_EQ(poses.back().fragment, fragment);
    poses.back().fragment = 0;  // joined
    closer.setPoses(poses);
    EXPECT_EQ(closer.poses().back().fragment, 0);
    closer.findLoops();
    EXPECT_GT(closer.counts().local, 0U);
  }
}

TEST(LoopCloser, PicturesThatLookDifferentWaysAreNotJoined) {
  // One picture, and the same as a camera would see it that is turned about its axis: aligned
  // without an error, but every surface is at another place of the picture.
  const double turn_rad = 0.35;
  const WorkingFrame frame = frameOf(0);
  LoopCloser closer(quick(), TrackingConfig{}, DepthSensor{});
  for (int i = 0; i < 3; ++i) closer.addKeyframe(keyframeView(frame, i, {0, poseOf(0)}, true));
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.rotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()));
  KeyframeView view = keyframeView(frame, 3, {0, poseOf(0) * turned}, true);
  const auto rotated = [&](cv::Mat image, int interpolation) {
    const cv::Point2f centre(static_cast<float>(view.camera.cx),
                             static_cast<float>(view.camera.cy));
    const cv::Mat by = cv::getRotationMatrix2D(centre, turn_rad * 180 / M_PI, 1.0);
    cv::warpAffine(image.clone(), image, by, image.size(), interpolation);
    return image;
  };
  view.intensity = rotated(view.intensity, cv::INTER_LINEAR);
  view.depth_mm = rotated(view.depth_mm, cv::INTER_NEAREST);
  closer.addKeyframe(view);
  EXPECT_TRUE(closer.findLoops().empty());
  EXPECT_GT(closer.counts().turned, 0U);
}

TEST(LoopCloser, TheLastKeyframesAreNoLoop) {
  LoopConfig config;
  config.min_gap_keyframes = kViews + 1;
  LoopCloser closer(config, TrackingConfig{}, DepthSensor{});
  EXPECT_TRUE(comeBack(closer, Eigen::Isometry3d::Identity()).empty());
  EXPECT_EQ(closer.counts().compared, 0U);
}

TEST(LoopCloser, FernsAreStoredByTheStaticViewRule) {
  for (const bool rule : {true, false}) {
    LoopConfig config = quick();
    config.static_view_rule = rule;
    LoopCloser closer(config, TrackingConfig{}, DepthSensor{});
    closer.addKeyframe(keyframeView(frameOf(0), 0, {0, poseOf(0)}, false));
    EXPECT_EQ(closer.counts().ferns, rule ? 0U : 1U);
    EXPECT_EQ(closer.counts().not_static, rule ? 1U : 0U);
    closer.addKeyframe(keyframeView(frameOf(0), 1, {0, poseOf(0)}, true));
    EXPECT_EQ(closer.counts().ferns, 1U);
  }
}

TEST(LoopCloser, RefusesWhatDoesNotFollow) {
  LoopCloser closer(quick(), TrackingConfig{}, DepthSensor{});
  closer.addKeyframe(keyframeView(frameOf(0), 3, {0, poseOf(0)}, true));
  EXPECT_THROW(closer.addKeyframe(keyframeView(frameOf(0), 3, {0, poseOf(0)}, true)), InputError);
  EXPECT_THROW(closer.setPoses({}), InputError);
}

TEST(LoopCloser, NoLoopLeadsToAForgottenKeyframe) {
  const auto loopsWithout = [](const std::vector<int>& forgotten) {
    LoopConfig config = quick();
    config.fern_novelty = 0;
    LoopCloser closer(config, {}, DepthSensor{});
    for (int i = 0; i < kViews; ++i) {
      closer.addKeyframe(keyframeView(frameOf(i), i, {0, poseOf(i)}, true));
    }
    const std::size_t ferns = closer.ferns().size();
    closer.forget(forgotten);
    EXPECT_EQ(closer.ferns().size(), ferns - forgotten.size());
    closer.addKeyframe(keyframeView(frameOf(0), kViews, {0, poseOf(0)}, true));
    std::set<std::int64_t> from;
    for (const LoopConstraint& loop : closer.findLoops()) from.insert(loop.from);
    return from;
  };
  ASSERT_EQ(loopsWithout({}).count(0), 1U);
  const auto left = loopsWithout({0});
  EXPECT_EQ(left.count(0), 0U);
  EXPECT_FALSE(left.empty()) << "others see the same";
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/pose_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "posefusion/core/error.hpp"
#include "posefusion/core/se3.hpp"
#include "random_pose.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

/// A random walk at 10 Hz and a noisy estimate of it in another frame.
std::vector<PosePair> walk(unsigned seed, double noise, int length = 60) {
  std::mt19937 random(seed);
  const Eigen::Isometry3d T_estimate_truth = randomPose(random, 2);
  Eigen::Isometry3d T = randomPose(random, 1);
  std::vector<PosePair> pairs;
  for (int i = 0; i < length; ++i) {
    const Eigen::Isometry3d found = T_estimate_truth * T * randomPose(random, noise);
    pairs.push_back({{i * 100 * kMs, T}, {i * 100 * kMs, found}});
    T = T * randomPose(random, 0.1);
  }
  return pairs;
}

double ateOf(const std::vector<PosePair>& pairs, AlignBy by) {
  return absolutePoseErrors(pairs, alignmentOf(pairs, by)).translation_m.rmse;
}

TEST(PoseComparison, WordsAreWhatTheyMean) {
  EXPECT_EQ(alignByNamed("none"), AlignBy::none);
  EXPECT_EQ(alignByNamed("se3"), AlignBy::rigid);
  EXPECT_EQ(alignByNamed("sim3"), AlignBy::similarity);
  EXPECT_EQ(alignByNamed("origin"), AlignBy::origin);
  EXPECT_EQ(stepUnitNamed("metres"), StepUnit::metres);
  EXPECT_EQ(errorOf([] { stepUnitNamed("feet"); }),
            "unit is 'feet', expected one of frames, seconds, metres");
}

TEST(PoseComparison, WithoutErrorEveryAlignmentButNoneGivesZero) {
  const auto pairs = walk(1, 0);
  EXPECT_GT(ateOf(pairs, AlignBy::none), 0.1);
  for (const AlignBy by : {AlignBy::rigid, AlignBy::similarity, AlignBy::origin}) {
    const PoseErrors errors = absolutePoseErrors(pairs, alignmentOf(pairs, by));
    EXPECT_NEAR(errors.translation_m.max, 0, 1e-9);
    EXPECT_NEAR(errors.rotation_deg.max, 0, 1e-5);
  }
}

TEST(PoseComparison, MoreFreedomFitsBetter) {
  for (unsigned seed = 1; seed < 6; ++seed) {
    const auto pairs = walk(seed, 0.05);
    EXPECT_LE(ateOf(pairs, AlignBy::similarity), ateOf(pairs, AlignBy::rigid) + 1e-12);
    EXPECT_LT(ateOf(pairs, AlignBy::rigid), ateOf(pairs, AlignBy::origin));
  }
}

TEST(PoseComparison, TheOriginLaysTheFirstPosesOnEachOther) {
  const auto pairs = walk(2, 0.05);
  const Alignment alignment = alignmentOf(pairs, AlignBy::origin);
  const PoseErrors first = absolutePoseErrors({pairs[0]}, alignment);
  EXPECT_NEAR(first.translation_m.max, 0, 1e-12);
  EXPECT_NEAR(first.rotation_deg.max, 0, 1e-5);
}

TEST(PoseComparison, StatisticsBelongTogether) {
  const auto pairs = walk(3, 0.05);
  const ErrorStatistics e =
      absolutePoseErrors(pairs, alignmentOf(pairs, AlignBy::rigid)).translation_m;
  EXPECT_EQ(e.count, pairs.size());
  EXPECT_NEAR(e.squares_sum, e.rmse * e.rmse * static_cast<double>(e.count), 1e-12);
  EXPECT_NEAR(e.deviation * e.deviation, e.rmse * e.rmse - e.mean * e.mean, 1e-12);
  EXPECT_LT(e.min, e.median);
  EXPECT_LT(e.median, e.max);
}

TEST(PoseComparison, RelativeErrorsDoNotDependOnARigidAlignment) {
  const auto pairs = walk(4, 0.02);
  for (const StepUnit unit : {StepUnit::frames, StepUnit::seconds, StepUnit::metres}) {
    for (const bool overlapping : {false, true}) {
      const Step step{1, unit, overlapping};
      const auto none = relativePoseErrors(pairs, alignmentOf(pairs, AlignBy::none), step);
      const auto rigid = relativePoseErrors(pairs, alignmentOf(pairs, AlignBy::rigid), step);
      ASSERT_GT(none.translation_m.count, 0U);
      EXPECT_NEAR(none.translation_m.rmse, rigid.translation_m.rmse, 1e-12);
      EXPECT_NEAR(none.rotation_deg.rmse, rigid.rotation_deg.rmse, 1e-9);
    }
  }
}

/// 0.25 m a frame along x at 10 Hz; the estimate is 4 % long.
std::vector<PosePair> straight(int length) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < length; ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().x() = 0.25 * i;
    Eigen::Isometry3d found = T;
    found.translation().x() *= 1.04;
    pairs.push_back({{i * 100 * kMs, T}, {i * 100 * kMs, found}});
  }
  return pairs;
}

TEST(PoseComparison, MotionsAreCountedByTheirUnit) {
  const auto pairs = straight(21);
  const Alignment none;
  const auto relative = [&](const Step& step) {
    return relativePoseErrors(pairs, none, step).translation_m;
  };
  EXPECT_EQ(relative({1, StepUnit::frames, false}).count, 20U);
  EXPECT_NEAR(relative({1, StepUnit::frames, false}).max, 0.01, 1e-12);
  EXPECT_EQ(relative({5, StepUnit::frames, false}).count, 4U);
  EXPECT_EQ(relative({5, StepUnit::frames, true}).count, 16U);
  EXPECT_NEAR(relative({5, StepUnit::frames, true}).mean, 0.05, 1e-12);
  EXPECT_EQ(relative({1, StepUnit::seconds, false}).count, 2U);
  EXPECT_EQ(relative({1, StepUnit::seconds, true}).count, 10U) << "none ends at the last pose";
  EXPECT_NEAR(relative({1, StepUnit::seconds, true}).mean, 0.10, 1e-12);
  // 1.04 m after four frames; the first begins there.
  EXPECT_EQ(relative({1, StepUnit::metres, false}).count, 4U);
  EXPECT_EQ(relative({1, StepUnit::metres, true}).count, 17U);
  EXPECT_EQ(relative({100, StepUnit::metres, true}).count, 0U);
}

TEST(PoseComparison, AScaleIsTakenOutOfMotionsToo) {
  const auto pairs = straight(21);
  Alignment alignment;
  alignment.scale = 1 / 1.04;
  const auto errors = relativePoseErrors(pairs, alignment, {5, StepUnit::frames, true});
  EXPECT_NEAR(errors.translation_m.max, 0, 1e-12);
}

TEST(PoseComparison, StepsThatAreNoneAreRefused) {
  const auto pairs = straight(5);
  EXPECT_THROW(relativePoseErrors(pairs, {}, {0, StepUnit::frames, false}), InputError);
  EXPECT_THROW(relativePoseErrors(pairs, {}, {1.5, StepUnit::frames, false}), InputError);
  EXPECT_THROW(relativePoseErrors(pairs, {}, {-1, StepUnit::metres, false}), InputError);
  EXPECT_THROW(relativePoseErrors(pairs, {}, {std::nan(""), StepUnit::metres, false}), InputError);
  EXPECT_EQ(relativePoseErrors({}, {}, {}).translation_m.count, 0U);
  EXPECT_THROW(alignmentOf({}, AlignBy::origin), InputError);
}

}  // namespace
}  // namespace pf

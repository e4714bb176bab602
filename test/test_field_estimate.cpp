// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/field_estimate.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "calibration_room.hpp"
#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

constexpr int kViewsOfRoom = 60;

std::vector<CalibrationView> distortedViews() {
  test::RoomView like;
  like.field = test::roomField();
  return test::roomViews(kViewsOfRoom, like);
}

const FieldEstimate& distortedEstimate() {
  static const FieldEstimate estimate = estimateField(distortedViews());
  return estimate;
}

TEST(FieldEstimate, recoversTheFieldOfASyntheticCamera) {
  const FieldEstimate& estimate = distortedEstimate();
  EXPECT_EQ(estimate.reason, "");
  EXPECT_TRUE(estimate.worth_taking);
  const FieldComparison like = compare(estimate.field, test::roomField());
  EXPECT_GE(like.correlation, 0.95);
  EXPECT_LT(like.rms_difference, 0.3 * like.rms_b);
  EXPECT_LT(estimate.kept_out.after_mm, estimate.kept_out.before_mm);
  EXPECT_GE(estimate.views, static_cast<std::size_t>(kViewsOfRoom));
}

TEST(FieldEstimate, hasNoMean) { EXPECT_NEAR(distortedEstimate().field.mean(), 0, 1e-15); }

TEST(FieldEstimate, poseErrorsOfACentimetreDoNotRuinIt) {
  test::RoomView like;
  like.field = test::roomField();
  like.pose_error_m = 0.007;
  const FieldEstimate estimate = estimateField(test::roomViews(kViewsOfRoom, like));
  EXPECT_GE(compare(estimate.field, test::roomField()).correlation, 0.9);
  EXPECT_TRUE(estimate.worth_taking);
}

TEST(FieldEstimate, aGoodCameraIsLeftAlone) {
  for (const double pose_error_m : {0.0, 0.005}) {
    test::RoomView like;
    like.pose_error_m = pose_error_m;
    const FieldEstimate estimate = estimateField(test::roomViews(kViewsOfRoom, like));
    EXPECT_LT(estimate.field.rms(), 0.0005) << pose_error_m;
    EXPECT_FALSE(estimate.worth_taking) << pose_error_m << ", " << estimate.kept_out.significance;
    EXPECT_NE(estimate.reason, "");
  }
}

TEST(FieldEstimate, aFewViewsAreEnoughForACameraThatIsFarOff) {
  test::RoomView like;
  like.field = test::roomField().then(test::roomField());
  const FieldEstimate estimate = estimateField(test::roomViews(23, like));
  EXPECT_LT(estimate.kept_out.pairs, 9U);
  EXPECT_TRUE(estimate.worth_taking) << estimate.reason;
  EXPECT_GE(compare(estimate.field, like.field).correlation, 0.8);
}

TEST(FieldEstimate, aFewViewsOfAGoodCameraProveNothing) {
  for (int count = 2; count <= 12; ++count) {
    test::RoomView like;
    like.pose_error_m = 0.005;
    const FieldEstimate estimate = estimateField(test::roomViews(count, like));
    EXPECT_FALSE(estimate.worth_taking) << count << ", " << estimate.kept_out.significance;
  }
}

TEST(FieldEstimate, repeatedItFindsNothingMore) {
  auto views = distortedViews();
  FieldEstimateConfig config;
  config.known = distortedEstimate().field;
  DepthCorrector corrector(config.known);
  for (CalibrationView& view : views) view.depth_mm = corrector.likeInput(view.depth_mm, 1e-3);
  const FieldEstimate again = estimateField(views, config);
  EXPECT_LT(again.field.rms(), 0.3 * again.left_per_m());
  EXPECT_NE(again.doubtOfStep(again.pairs), "");
}

TEST(FieldEstimate, whatIsKnownMayHaveAnotherGrid) {
  FieldEstimateConfig config;
  config.known = DepthField(16, 12);  // nothing, as by default
  const FieldEstimate estimate = estimateField(distortedViews(), config);
  EXPECT_LT(compare(estimate.field, distortedEstimate().field).rms_difference, 1e-9);
}

TEST(FieldEstimate, aStepIsTakenFromMorePairsThatAgreeNoWorse) {
  FieldEstimate step;
  step.pairs = 130;
  step.kept_out.pairs = 30;
  step.kept_out.significance = -1.0;
  EXPECT_EQ(step.doubtOfStep(100), "");
  EXPECT_NE(step.doubtOfStep(110), "");
  EXPECT_NE(step.doubtOfStep(0), "");
  step.kept_out.significance = -2.0;
  EXPECT_NE(step.doubtOfStep(100), "");
  step.kept_out.significance = 4.0;
  EXPECT_EQ(step.doubtOfStep(1000), "");
}

TEST(FieldEstimate, aCameraIsClearedByWhatWouldHaveFoundItOff) {
  const DepthSensor sensor;
  FieldEstimate nothing;
  EXPECT_FALSE(nothing.clears(sensor)) << "no pair has judged";
  nothing.kept_out.pairs = 4;
  nothing.kept_out.significance = 1.0;
  nothing.sigma_per_m = 0.1 * sensor.systematic_1_m;
  EXPECT_TRUE(nothing.clears(sensor));
  nothing.kept_out.significance = 2.0;
  EXPECT_FALSE(nothing.clears(sensor)) << "it is probably off";
  nothing.kept_out.significance = 1.0;
  nothing.sigma_per_m = sensor.systematic_1_m;
  EXPECT_FALSE(nothing.clears(sensor)) << "as much would not have been found";
}

TEST(FieldEstimate, depthNearTheEndOfTheRangeIsIgnored) {
  // Only points measured too near are left of a wall near the end of the range: they would bend the
  // field.
  CalibrationView view;
  view.camera = test::roomCamera();
  view.depth_mm = cv::Mat(view.camera.height, view.camera.width, CV_16UC1, cv::Scalar(4940));
  view.sensor.max_depth_m = 5.0;
  EXPECT_TRUE(ViewSurface(view).patches().empty());
  view.sensor.max_depth_m = 8.0;
  EXPECT_FALSE(ViewSurface(view).patches().empty());
}

TEST(FieldEstimate, theOrderOfTheViewsAndThreadsDoNotMatter) {
  auto views = distortedViews();
  std::reverse(views.begin(), views.end());
  std::swap(views[3], views[20]);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const FieldEstimate estimate = estimateField(views);
  EXPECT_EQ(estimate.field.nodes(), distortedEstimate().field.nodes());
  EXPECT_EQ(estimate.kept_out.significance, distortedEstimate().kept_out.significance);
}

TEST(FieldEstimate, viewsOfDifferentFragmentsMakeNoPair) {
  // Each fragment has coordinates of its own: poses of two of them cannot be compared.
  auto views = distortedViews();
  std::vector<ViewSurface> surfaces;
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i].fragment = static_cast<int>(i % 2);
    surfaces.emplace_back(views[i]);
  }
  const std::vector<ViewPair> pairs = overlappingPairs(surfaces);
  EXPECT_GT(pairs.size(), 10U);
  for (const ViewPair& pair : pairs) {
    EXPECT_EQ(surfaces[pair.from].fragment(), surfaces[pair.to].fragment());
  }
}

TEST(FieldEstimate, reportsWhatIsMissing) {
  test::RoomView like;
  like.field = test::roomField();
  const FieldEstimate few = estimateField(test::roomViews(3, like));
  EXPECT_FALSE(few.worth_taking);
  EXPECT_NE(few.reason.find("3 keyframes"), std::string::npos) << few.reason;
  EXPECT_EQ(few.field.rms(), 0);
  EXPECT_FALSE(estimateField({}).worth_taking);
}

TEST(FieldEstimate, refusesAnImageThatIsNotItsCameras) {
  auto views = distortedViews();
  views[1].camera.width = 320;
  EXPECT_THROW(estimateField(views), InputError);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
// Whether alignments by a camera with systematic errors are as far from the truth as reported.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "../src/tracking/place_errors.hpp"
#include "mapper_scene.hpp"
#include "posefusion/calibration/depth_correction.hpp"
#include "posefusion/loop/verify.hpp"

namespace pf {
namespace {

constexpr int kCameras = 40;
constexpr double kSystematic_1_m = 0.001;

/// Every node of the field is off by so much, whatever the others are.
DepthField randomField(double sigma_1_m, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, sigma_1_m);
  std::vector<double> nodes(static_cast<std::size_t>(DepthField::kColumns) * DepthField::kRows);
  for (double& node : nodes) node = normal(random);
  return DepthField(DepthField::kColumns, DepthField::kRows, nodes);
}

class PoseCovarianceTest : public MapperTest {
 protected:
  PoseCovarianceTest() : truth_(room().frame(0)) {
    Mapper mapper(config());
    for (int i = 0; i < 5; ++i) mapper.process({room().frame(i).frame, {}, {}});
    model_.assign(mapper.render(truth_.frame.camera, truth_.T_map_camera), DepthSensor{});
  }

  /// As a camera sees it that is off.
  WorkingFrame seen(const DepthField& off, const DepthSensor& sensor) const {
    RgbdFrame measured = truth_.frame;
    measured.depth = DepthCorrector(off).likeInput(measured.depth, measured.depth_unit_m);
    WorkingFrame frame;
    frame.assign(measured, {}, config().frame, sensor);
    return frame;
  }

  static DepthSensor sensorWith(double systematic_1_m) {
    DepthSensor sensor;
    sensor.systematic_1_m = static_cast<float>(systematic_1_m);
    sensor.step_1_m = 0.0F;
    return sensor;
  }

  static TermSettings settingsOf(const DepthSensor& sensor) {
    TermSettings settings;
    settings.photometric_sigma = 0.0F;
    settings.sensor = sensor;
    return settings;
  }

  TrackingResult aligned(double systematic_1_m) const {
    TrackingStart start = freeStart(truth_.T_map_camera);
    start.with_systematic = true;
    return track(seen(DepthField(), sensorWith(systematic_1_m)), model_, start, TrackingConfig{});
  }

  TrueFrame truth_;
  ModelPyramid model_;
};

TEST_F(PoseCovarianceTest, SystematicErrorsPullAsHardAsPredicted) {
  const DepthSensor sensor = sensorWith(kSystematic_1_m);
  const TermSettings settings = settingsOf(sensor);
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  const auto pull = [&](const DepthField& off) {
    const WorkingFrame frame = seen(off, sensor);
    return buildNormalEquations(model_.level(0), frame.levels[0], still, settings).gradient();
  };
  const WorkingFrame straight = seen(DepthField(), sensor);
  const PlaceErrors predicted = placeErrors(model_.level(0), straight.levels[0], still, settings);
  const Vector6d none = pull(DepthField());
  double nees = 0;
  for (unsigned seed = 0; seed < kCameras; ++seed) {
    const Vector6d g = pull(randomField(kSystematic_1_m, seed)) - none;
    nees += g.dot(predicted.gradient.ldlt().solve(g)) / kCameras;
  }
  // 6, give or take 0.55, had places the edges and the shape of a field's nodes.
  EXPECT_GT(nees, 3.5);
  EXPECT_LT(nees, 8.5);
}

TEST_F(PoseCovarianceTest, ItGrowsWithTheAssumedErrorAndIsNoneWithoutIt) {
  const Matrix6d once = aligned(kSystematic_1_m).systematic;
  const Matrix6d twice = aligned(2.0 * kSystematic_1_m).systematic;
  EXPECT_GT(once.norm(), 0.0);
  EXPECT_TRUE(twice.isApprox(4.0 * once, 1e-4));
  EXPECT_EQ(aligned(0.0).systematic.norm(), 0.0);
}

TEST_F(PoseCovarianceTest, ItIsSmallerAtRestThanInATurn) {
  Mapper rests(config()), moves(config());
  const RgbdFrame first = room().frame(0).frame;
  FrameStatus at_rest, in_motion;
  for (int i = 0; i < 40; ++i) {
    RgbdFrame frame = first;
    frame.stamp_ns = room().stamp(i);
    at_rest = rests.process({frame, {}, {}});
    in_motion = moves.process({room().frame(i).frame, {}, {}});
  }
  ASSERT_EQ(at_rest.outcome, FrameOutcome::fused);
  EXPECT_LT(at_rest.covariance.trace(), 0.7 * in_motion.covariance.trace());
  EXPECT_GT(at_rest.covariance.diagonal().minCoeff(), 0.0);
}

}  // namespace
}  // namespace pf

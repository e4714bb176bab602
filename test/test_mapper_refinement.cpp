// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mapper_scene.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {
namespace {

class MapperRefinementTest : public MapperTest {
 protected:
  static Config dense() {
    Config c = config();
    c.graph.keyframe_distance_m = 0.06;
    c.graph.keyframe_angle_rad = 0.06;
    // The room is drawn without systematic errors: constraints are as good as their covariances.
    c.graph.odometry_sigma_m = c.graph.loop_sigma_m = 0.002;
    c.graph.odometry_sigma_rad = c.graph.loop_sigma_rad = 0.002;
    return c;
  }

  static SavedMap mapped() {
    Mapper mapper(dense());
    for (int i = 0; i < 60; ++i) mapper.process({room().frame(i).frame, {}, {}});
    SavedMap map = mapper.saved(room().frame(0).frame.camera);
    map.calibration.emplace();  // of a camera that nothing is wrong with
    map.calibration->camera = map.camera;
    return map;
  }

  /// As if tracking had drifted along: constraints and poses alike.
  static SavedMap drifted() {
    SavedMap map = mapped();
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    const std::vector<Keyframe> before = map.keyframes;
    for (std::size_t i = 1; i < map.keyframes.size(); ++i) {
      Vector6d step;
      step << 0.006, -0.004, 0.003, 0.001, -0.002, 0.001;
      T = T * expSe3(step);
      map.keyframes[i].T_map_camera = before[i].T_map_camera * T;
    }
    for (PoseConstraint& c : map.constraints) {
      const auto pose = [&](int k) {
        return map.keyframes[static_cast<std::size_t>(k)].T_map_camera;
      };
      c.T_from_to = pose(c.from).inverse() * pose(c.to);
    }
    return map;
  }

  /// Of the keyframes against the truth (m, RMS).
  static double error_m(const Mapper& mapper) {
    double sum = 0;
    const auto& keyframes = mapper.backEnd().graph().keyframes();
    for (const Keyframe& k : keyframes) {
      int index = 0;
      while (room().stamp(index) != k.stamp_ns) ++index;
      sum += (k.T_map_camera.translation() - room().pose(index).translation()).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(keyframes.size()));
  }
};

TEST_F(MapperRefinementTest, DriftIsMendedByPairsThatSeeTheSame) {
  Mapper mapper(dense());
  mapper.load(drifted(), MapUse::extend);
  const double before_m = error_m(mapper);
  ASSERT_GT(mapper.backEnd().graph().keyframes().size(), 5U);
  EXPECT_GT(before_m, 0.015);
  const Mapper::Refinement done = mapper.refine();
  EXPECT_LT(error_m(mapper), 0.3 * before_m);
  EXPECT_GT(done.largest_shift_m, 0.02);
  EXPECT_GT(done.measured, mapper.backEnd().graph().keyframes().size()) << "not only neighbours";
  EXPECT_LE(done.measured, done.pairs);
  EXPECT_EQ(done.text().rfind("refined: " + std::to_string(done.pairs), 0), 0U) << done.text();
}

TEST_F(MapperRefinementTest, OfACameraThatIsNotKnownNothingIsAligned) {
  SavedMap map = drifted();
  map.calibration.reset();
  Mapper mapper(dense());
  mapper.load(map, MapUse::extend);
  const double before_m = error_m(mapper);
  const Mapper::Refinement done = mapper.refine();
  EXPECT_EQ(done.reason,
            "what depth is off by is not known: pairs that were kept out do not agree better by "
            "more than luck explains");
  EXPECT_EQ(done.text(), "not refined: " + done.reason);
  EXPECT_EQ(done.pairs, 0U);
  EXPECT_EQ(error_m(mapper), before_m);
}

TEST_F(MapperRefinementTest, OneKeyframeIsReportedAsTooFew) {
  Mapper mapper(dense());
  mapper.process({room().frame(0).frame, {}, {}});
  EXPECT_EQ(mapper.refine().text(),
            "not refined: there is one keyframe, which nothing compares with");
}

TEST_F(MapperRefinementTest, AGoodMapStaysGoodAndTwiceIsNoMoreThanOnce) {
  Mapper mapper(dense());
  mapper.load(mapped(), MapUse::extend);
  const double before_m = error_m(mapper);
  mapper.refine();
  EXPECT_LT(error_m(mapper), before_m + 0.002);
  EXPECT_LT(mapper.refine().largest_shift_m, 0.002);
}

TEST_F(MapperRefinementTest, IsTheSameForAnyNumberOfThreadsAndChangesNothingWhereItMustNot) {
  const SavedMap map = drifted();
  Mapper many(dense()), one(dense()), fixed(dense());
  many.load(map, MapUse::extend);
  one.load(map, MapUse::extend);
  fixed.load(map, MapUse::localize_only);
  many.refine();
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    one.refine();
  }
  EXPECT_EQ(many.map().collect().x, one.map().collect().x);
  EXPECT_EQ(error_m(many), error_m(one));
  const double before_m = error_m(fixed);
  const Mapper::Refinement none = fixed.refine();
  EXPECT_EQ(none.pairs, 0U);
  EXPECT_EQ(none.reason, "the map may not change");
  EXPECT_EQ(error_m(fixed), before_m);
}

}  // namespace
}  // namespace pf

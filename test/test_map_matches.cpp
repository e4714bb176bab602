// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/map_matches.hpp"

#include <gtest/gtest.h>

#include "mapper_scene.hpp"
#include "posefusion/core/se3.hpp"
#include "posefusion/map/surfel_map.hpp"

namespace pf {
namespace {

class MapMatches : public MapperTest {
 protected:
  static Config dense() {
    Config c = config();
    c.graph.keyframe_distance_m = 0.08;
    c.graph.keyframe_angle_rad = 0.08;
    return c;
  }

  static const Mapper& mapper() {
    static const Mapper& made = *[] {
      auto* mapper = new Mapper(dense());
      for (int i = 0; i < 60; ++i) mapper->process({room().frame(i).frame, {}, {}});
      return mapper;
    }();
    return made;
  }

  /// The keyframes once more, as those of another map: with numbers above.
  static std::vector<KeyframeView> again() {
    std::vector<KeyframeView> views = mapper().keyframeViews();
    for (KeyframeView& view : views) view.id += 1000;
    return views;
  }

  static std::vector<KeyframeView> moved(std::vector<KeyframeView> views, double ahead_m) {
    for (KeyframeView& view : views) {
      view.pose.T_map_camera.translate(Eigen::Vector3d(0, 0, ahead_m));
    }
    return views;
  }

  static MapMatcher matcher() {
    return {dense().loop, dense().tracking, depthSensorOf(dense()), mapper().keyframeViews()};
  }

  /// Error of the position that a loop gives the view that it leads to (m).
  static double errorM(const PoseConstraint& loop) {
    const auto& views = mapper().keyframeViews();
    const auto pose = [&](int i) { return views[static_cast<std::size_t>(i)].pose.T_map_camera; };
    const Eigen::Isometry3d off =
        (pose(loop.from) * loop.T_from_to).inverse() * pose(loop.to - 1000);
    return off.translation().norm();
  }
};

TEST_F(MapMatches, PicturesAreFoundByTheirFeatures) {
  const std::vector<PoseConstraint> loops = matcher().verified(matcher().placesLike(again()));
  ASSERT_GE(loops.size(), mapper().keyframeViews().size() / 2);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    EXPECT_LT(errorM(loops[i]), 0.02) << loops[i].from << " -> " << loops[i].to;
    EXPECT_LT(angleOf(loops[i].T_from_to), kMostTurn_rad);
    if (i == 0) continue;
    EXPECT_LT(std::make_pair(loops[i - 1].to, loops[i - 1].from),
              std::make_pair(loops[i].to, loops[i].from))
        << "each pair once, in order";
  }
}

TEST_F(MapMatches, PicturesAreFoundByDrawingTheMap) {
  const auto map = std::make_shared<const SurfelMap>(mapper().map());
  const std::vector<KeyframeView> few = {again().front(), again().back()};
  const std::vector<KeyframeView> found = matcher().placesIn(map, few);
  ASSERT_EQ(found.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found[i].id, few[i].id);
    const Eigen::Isometry3d off = found[i].pose.T_map_camera.inverse() * few[i].pose.T_map_camera;
    EXPECT_LT(off.translation().norm(), 0.03);
  }
}

TEST_F(MapMatches, AGuessThatIsOffIsAlignedAndAWrongOneIsRefused) {
  for (const PoseConstraint& loop : matcher().verified(moved(again(), 0.05))) {
    EXPECT_LT(errorM(loop), 0.02);
  }
  for (const PoseConstraint& loop : matcher().verified(moved(again(), 0.8))) {
    EXPECT_LT(errorM(loop), 0.02) << "an accepted loop is right";
  }
  EXPECT_TRUE(matcher().verified(moved(again(), 30)).empty()) << "nothing was seen from near there";
  EXPECT_TRUE(matcher().verified({}).empty());
}

TEST_F(MapMatches, WithoutKnownPicturesNothingIsFound) {
  const MapMatcher none(dense().loop, dense().tracking, depthSensorOf(dense()), {});
  const auto map = std::make_shared<const SurfelMap>(mapper().map());
  EXPECT_TRUE(none.placesLike(again()).empty());
  EXPECT_TRUE(none.placesIn(map, again()).empty());
  EXPECT_TRUE(none.verified(again()).empty());
}

TEST_F(MapMatches, PicturesAtWrongPosesLookThroughTheMap) {
  const DepthSensor sensor = depthSensorOf(dense());
  const std::vector<KeyframeView> views = mapper().keyframeViews();
  const LookedThrough right = lookedThrough(mapper().map(), views, sensor);
  EXPECT_EQ(right.compared, views.size());
  EXPECT_EQ(right.through, 0U);
  const LookedThrough wrong = lookedThrough(mapper().map(), moved(views, 0.6), sensor);
  EXPECT_GT(2 * wrong.through, wrong.compared);
  const LookedThrough away = lookedThrough(mapper().map(), moved(views, 50), sensor);
  EXPECT_EQ(away.compared, 0U);
}

}  // namespace
}  // namespace pf

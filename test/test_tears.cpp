// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/tears.hpp"

#include <gtest/gtest.h>

#include "posefusion/core/se3.hpp"
#include "posefusion/map/deform.hpp"
#include "posefusion/map/layers.hpp"

namespace pf {
namespace {

/// Adds a wall z = `z` from x = `from` on, 4 m long, made in one frame.
void addWall(SurfelArrays& s, float from, float z, int created) {
  for (int k = 0; k < 200 * 20; ++k) {
    s.forEachArray([](auto& array) { array.push_back(0); });
    s.x.back() = from + 0.02F * static_cast<float>(k % 200);
    s.y.back() = 0.02F * static_cast<float>(k / 200);
    s.z.back() = z;
    s.nz.back() = -1;
    s.radius.back() = 0.015F;
    s.odds.back() = static_odds::kMost;
    s.created.back() = created;
  }
}

std::vector<Keyframe> keyframesAt(const std::vector<Eigen::Isometry3d>& poses) {
  std::vector<Keyframe> keyframes;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Keyframe k;
    k.id = static_cast<int>(i);
    k.map_frame = static_cast<std::int32_t>(100 * i);
    k.T_map_camera = poses[i];
    keyframes.push_back(k);
  }
  return keyframes;
}

Eigen::Isometry3d motion(double x, double z, double yaw = 0) {
  Vector6d twist;
  twist << x, 0, z, 0, yaw, 0;
  return expSe3(twist);
}

/// A wall seen from the first keyframe, and from its middle on again from the last, which has
/// drifted; between them others that see elsewhere.
class TearsTest : public ::testing::Test {
 protected:
  TearsTest() {
    SurfelArrays surfels;
    addWall(surfels, 0, 2.0F, 0);
    addWall(surfels, 2, 2.0F + kDrift_m, 400);
    addWall(surfels, 20, 2.0F, 200);
    map_.restore({{kFirstFragment, surfels}}, 500);
  }

  std::vector<std::uint32_t> torn(const std::vector<Eigen::Isometry3d>& motions, SurfelMap& now) {
    std::vector<Keyframe> moved = before_;
    std::vector<Deformation::Node> nodes;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      moved[i].T_map_camera = motions[i] * moved[i].T_map_camera;
      nodes.push_back({moved[i].map_frame, motions[i], true});
    }
    now = map_;
    deform(now, Deformation(1, nodes));
    return tornBlocks(map_, now, before_, moved);
  }

  static constexpr float kDrift_m = 0.2F;
  SurfelMap map_{MapConfig{}};
  const std::vector<Keyframe> before_ =
      keyframesAt(std::vector<Eigen::Isometry3d>(5, Eigen::Isometry3d::Identity()));
};

TEST_F(TearsTest, WhereAllGoesAlongNothingIsTorn) {
  SurfelMap now = map_;
  EXPECT_TRUE(torn(std::vector<Eigen::Isometry3d>(5, motion(3, -1, 0.8)), now).empty());
}

TEST_F(TearsTest, ALoopTearsWhereBothPassesLieAndNowhereElse) {
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  SurfelMap now = map_;
  const auto found =
      torn({still, motion(0, -0.06), motion(0, -0.12), motion(0, -0.16), motion(0, -0.18)}, now);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(found.size(), map_.blocks().size());
  for (const std::uint32_t block : found) {
    EXPECT_GT(now.blocks()[block].bounds.max().x(), 1.4F);
    EXPECT_LT(now.blocks()[block].bounds.min().x(), 6.5F) << "what lies apart moves freely";
  }
  SurfelMap all = now;
  const std::size_t expected = removeYoungerLayers(all);
  EXPECT_GT(expected, 1000U);
  EXPECT_EQ(removeYoungerLayers(now, found), expected);
}

TEST_F(TearsTest, ATurnAboutFarAwayTearsToo) {
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  SurfelMap now = map_;
  EXPECT_FALSE(torn({still, still, still, still, motion(0, 0, 0.01)}, now).empty());
  EXPECT_TRUE(torn({still, still, still, still, motion(0, 0.001)}, now).empty())
      << "less than noise";
}

}  // namespace
}  // namespace pf

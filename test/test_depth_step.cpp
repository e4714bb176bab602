// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/depth_step.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "calibration_room.hpp"

namespace pf {
namespace {

constexpr int kWidth = 80;

/// A slanted wall as a camera at `T` sees it, its depth off by the field; one surfel a pixel.
SurfelArrays wallSeen(const Eigen::Isometry3d& T, const DepthField& error, int created) {
  const PinholeCamera camera = test::roomCamera(kWidth);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -1).normalized();
  SurfelArrays s;
  s.resize(static_cast<std::size_t>(camera.width * camera.height));
  std::size_t i = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u, ++i) {
      const Eigen::Vector3d ray = camera.unproject(u, v, 1.0);
      const double z = -2.5 / normal.dot(ray);  // the plane normal . p = -2.5
      const double seen =
          error.inverse().corrected(z, (u + 0.5) / camera.width, (v + 0.5) / camera.height);
      const Eigen::Vector3f p = (T * (seen * ray)).cast<float>();
      const Eigen::Vector3f n = (T.linear() * normal).cast<float>();
      s.x[i] = p.x(), s.y[i] = p.y(), s.z[i] = p.z();
      s.nx[i] = n.x(), s.ny[i] = n.y(), s.nz[i] = n.z();
      s.radius[i] = 0.02F;
      s.odds[i] = static_odds::kMost;
      s.created[i] = created;
    }
  }
  return s;
}

Keyframe keyframe(int id, int map_frame, const Eigen::Isometry3d& T, int fragment) {
  Keyframe k;
  k.id = id;
  k.map_frame = map_frame;
  k.T_map_camera = T;
  k.fragment = fragment;
  return k;
}

/// Two walls, seen from two keyframes.
struct TwoWalls {
  Eigen::Isometry3d T_first = test::roomPose(3), T_second = test::roomPose(11);
  SurfelMap map{MapConfig()};
  DepthStep step{
      test::roomField(),
      test::roomCamera(kWidth),
      {keyframe(0, 0, T_first, kFirstFragment), keyframe(1, 50, T_second, kFirstFragment)}};

  explicit TwoWalls(const DepthField& error) {
    for (int i = 0; i < 60; ++i) map.advance();
    map.add(wallSeen(T_first, error, 20));
    map.add(wallSeen(T_second, error, 55));
  }

  /// Largest distance (m) of a surfel to the wall of its keyframe.
  double worst_m() const {
    const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -1).normalized();
    double worst = 0;
    map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
      const Eigen::Isometry3d& T = s.created[i] < 50 ? T_first : T_second;
      const Eigen::Vector3d p = T.inverse() * Eigen::Vector3d(s.x[i], s.y[i], s.z[i]);
      worst = std::max(worst, std::abs(normal.dot(p) + 2.5));
    });
    return worst;
  }
};

TEST(DepthStep, bringsSurfelsToWhereTheirKeyframesSeeThemNow) {
  TwoWalls walls(test::roomField());
  const std::size_t count = walls.map.size();
  EXPECT_GT(walls.worst_m(), 0.02);
  correctDepth(walls.map, walls.step);
  EXPECT_EQ(walls.map.size(), count);
  EXPECT_LT(walls.worst_m(), 1e-5);
}

/// A wall 4 m from one keyframe and 2 m from another one beside it, as a mean of what both see of
/// it. The second one was believed to be where a motion from its true place takes it.
struct WallSeenTwice {
  Eigen::Isometry3d T_far = Eigen::Isometry3d::Identity(), T_near = T_far, T_false_true = T_far;
  SurfelMap map{MapConfig()};

  explicit WallSeenTwice(const DepthField& error,
                         const Eigen::Isometry3d& off = Eigen::Isometry3d::Identity())
      : T_false_true(off) {
    T_near.translation() = Eigen::Vector3d(0.6, 0.2, 2.0);
    for (int i = 0; i < 60; ++i) map.advance();
    SurfelArrays s;
    for (double y = -0.3; y < 0.5; y += 0.05) {
      for (double x = 0.0; x < 1.2; x += 0.05) add({x, y, 4.0}, error, s);
    }
    map.add(s);
  }

  static Eigen::Vector3d seenFrom(const Eigen::Isometry3d& T, const Eigen::Vector3d& point,
                                  const DepthField& error) {
    const PinholeCamera camera = test::roomCamera(kWidth);
    const Eigen::Vector3d p = T.inverse() * point;
    const Eigen::Vector2d pixel = camera.project(p);
    const double z = error.inverse().corrected(p.z(), (pixel.x() + 0.5) / camera.width,
                                               (pixel.y() + 0.5) / camera.height);
    return T * (p * (z / p.z()));
  }

  void add(const Eigen::Vector3d& point, const DepthField& error, SurfelArrays& s) const {
    constexpr double kFar = 1.0 / 256, kNear = 1.0 / 16;  // 1 / variance, as fusion weighs
    const Eigen::Vector3d mean = (kFar * seenFrom(T_far, point, error) +
                                  kNear * (T_false_true * seenFrom(T_near, point, error))) /
                                 (kFar + kNear);
    s.resize(s.size() + 1);
    const std::size_t i = s.size() - 1;
    s.x[i] = static_cast<float>(mean.x());
    s.y[i] = static_cast<float>(mean.y());
    s.z[i] = static_cast<float>(mean.z());
    s.nx[i] = s.ny[i] = 0.0F;
    s.nz[i] = -1.0F;
    s.radius[i] = 0.02F;
    s.odds[i] = static_odds::kMost;
    s.created[i] = 20;
    s.seen[i] = 55;
  }

  double worst_m() const {
    double worst = 0;
    map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
      worst = std::max(worst, std::abs(s.z[i] - 4.0));
    });
    return worst;
  }
};

TEST(DepthStep, goesByAllKeyframesThatSawASurfelAsFusionWeighsThem) {
  WallSeenTwice wall(test::roomField());
  const double before_m = wall.worst_m();
  EXPECT_GT(before_m, 0.02);
  correctDepth(wall.map, {test::roomField(),
                          test::roomCamera(kWidth),
                          {keyframe(0, 0, wall.T_far, kFirstFragment),
                           keyframe(1, 50, wall.T_near, kFirstFragment)}});
  EXPECT_LT(wall.worst_m(), 0.1 * before_m);
}

TEST(DepthStep, goesFromWhereKeyframesWereToWhereTheyAre) {
  Eigen::Isometry3d off(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX()));
  off.translation() = Eigen::Vector3d(0.02, -0.01, 0.04);
  for (const DepthField& error : {DepthField(), test::roomField()}) {
    WallSeenTwice wall(error, off);
    const double before_m = wall.worst_m();
    EXPECT_GT(before_m, 0.02);
    DepthStep step{
        error,
        test::roomCamera(kWidth),
        {keyframe(0, 0, wall.T_far, kFirstFragment), keyframe(1, 50, wall.T_near, kFirstFragment)}};
    step.motion = Deformation(1, {{0, Eigen::Isometry3d::Identity(), true, kFirstFragment},
                                  {50, off.inverse(), false, kFirstFragment}});
    correctDepth(wall.map, step);
    EXPECT_LT(wall.worst_m(), 0.12 * before_m);
  }
}

TEST(DepthStep, andItsInverseLeaveEverythingWhereItWas) {
  TwoWalls walls{DepthField()};
  const SurfelArrays before = walls.map.collect();
  correctDepth(walls.map, walls.step);
  walls.step.field = walls.step.field.inverse();
  correctDepth(walls.map, walls.step);
  EXPECT_LT(walls.worst_m(), 1e-5);
  double radius = 0, turn = 1;
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, -1).normalized();
  walls.map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    const Eigen::Isometry3d& T = s.created[i] < 50 ? walls.T_first : walls.T_second;
    turn = std::min(
        turn, normal.dot(T.linear().transpose() * Eigen::Vector3d(s.nx[i], s.ny[i], s.nz[i])));
    radius = std::max(radius, std::abs(s.radius[i] - 0.02));
  });
  EXPECT_GT(turn, 0.99999);
  EXPECT_LT(radius, 1e-6);
  EXPECT_EQ(walls.map.size(), before.size());
}

TEST(DepthStep, turnsNormalsAsTheSurfaceBends) {
  // Against differences of neighbouring surfels of a wall that was flat.
  TwoWalls walls{DepthField()};
  const Eigen::Isometry3d T = walls.T_first;
  SurfelMap map{MapConfig()};
  map.advance();
  map.add(wallSeen(T, DepthField(), 0));
  walls.step.keyframes.resize(1);
  correctDepth(map, walls.step);
  const auto index = [](int u, int v) { return static_cast<std::size_t>(v * kWidth + u); };
  // Blocks have taken them apart: brought together again by their rays.
  const PinholeCamera camera = test::roomCamera(kWidth);
  std::vector<Eigen::Vector3d> p(static_cast<std::size_t>(camera.width * camera.height)), n = p;
  map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    const Eigen::Vector3d at = T.inverse() * Eigen::Vector3d(s.x[i], s.y[i], s.z[i]);
    const Eigen::Vector2d pixel = camera.project(at);
    const std::size_t k =
        index(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
    p[k] = at;
    n[k] = T.linear().transpose() * Eigen::Vector3d(s.nx[i], s.ny[i], s.nz[i]);
  });
  double worst = 0, moved = 0;
  const Eigen::Vector3d flat = Eigen::Vector3d(0.3, -0.2, -1).normalized();
  for (int v = 5; v < camera.height - 5; v += 6) {
    for (int u = 5; u < camera.width - 5; u += 6) {
      const Eigen::Vector3d du = p[index(u + 2, v)] - p[index(u - 2, v)];
      const Eigen::Vector3d dv = p[index(u, v + 2)] - p[index(u, v - 2)];
      const Eigen::Vector3d wanted = -du.cross(dv).normalized();
      worst = std::max(worst, std::acos(std::min(1.0, wanted.dot(n[index(u, v)]))));
      moved = std::max(moved, std::acos(std::min(1.0, flat.dot(wanted))));
    }
  }
  EXPECT_GT(moved, 0.02);
  EXPECT_LT(worst, 0.1 * moved);
}

TEST(DepthStep, leavesWhatHasNoKeyframeAndDoesNotDependOnThreads) {
  TwoWalls many(test::roomField()), one(test::roomField());
  correctDepth(many.map, many.step);
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    correctDepth(one.map, one.step);
  }
  EXPECT_EQ(many.map.collect().x, one.map.collect().x);
  EXPECT_EQ(many.map.collect().nz, one.map.collect().nz);
  TwoWalls elsewhere(test::roomField());
  const SurfelArrays before = elsewhere.map.collect();
  for (Keyframe& k : elsewhere.step.keyframes) k.fragment = kFirstFragment + 1;
  correctDepth(elsewhere.map, elsewhere.step);
  EXPECT_EQ(elsewhere.map.collect().z, before.z);
}

}  // namespace
}  // namespace pf

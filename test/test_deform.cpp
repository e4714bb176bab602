// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/deform.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <random>

#include "posefusion/core/se3.hpp"
#include "posefusion/map/render.hpp"
#include "small_camera.hpp"

namespace pf {
namespace {

constexpr int kFrames = 100;

Eigen::Isometry3d motion(double x, double y, double z, double yaw) {
  Vector6d twist;
  twist << x, y, z, 0.3 * yaw, yaw, 0;
  return expSe3(twist);
}

/// A wavy wall 2 m before the origin, made by kFrames frames from left to right.
SurfelArrays wall() {
  SurfelArrays s;
  s.resize(120 * 90);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const auto u = static_cast<float>(i / 90), v = static_cast<float>(i % 90);
    s.x[i] = 0.02F * (u - 60.0F);
    s.y[i] = 0.02F * (v - 45.0F);
    s.z[i] = 2.0F + 0.1F * std::sin(0.2F * u);
    const Eigen::Vector3f n = Eigen::Vector3f(0.2F * std::sin(0.1F * v), 0, -1).normalized();
    s.nx[i] = n.x(), s.ny[i] = n.y(), s.nz[i] = n.z();
    s.r[i] = s.g[i] = s.b[i] = static_cast<float>(i % 200);
    s.radius[i] = 0.02F;
    s.weight[i] = 50;
    s.odds[i] = static_odds::kMost;
    s.created[i] = static_cast<std::int32_t>(i * kFrames / s.size());
    s.seen[i] = kFrames - 1;
  }
  return s;
}

SurfelMap deformable(const SurfelArrays& surfels, double memory_limit_mb = 100) {
  MapConfig config;
  config.memory_limit_mb = memory_limit_mb;
  SurfelMap map(config);
  for (int i = 0; i < kFrames; ++i) map.advance();
  map.add(surfels);
  return map;
}

Deformation everything(const Eigen::Isometry3d& T) { return Deformation(1, {{0, T, false}}); }

/// Nothing until frame 40, then more and more.
Deformation bend() {
  return Deformation(1, {{0, Eigen::Isometry3d::Identity(), true},
                         {40, Eigen::Isometry3d::Identity(), true},
                         {70, motion(0.1, 0.05, 0.3, 0.1), true},
                         {99, motion(0.9, -0.2, 0.1, -0.4), false}});
}

void expectEqual(const SurfelMap& a, const SurfelMap& b) {
  ASSERT_EQ(a.blocks().size(), b.blocks().size());
  for (std::size_t k = 0; k < a.blocks().size(); ++k) {
    SurfelArrays one = a.blocks()[k].surfels;
    one.forEachArray(b.blocks()[k].surfels,
                     [](const auto& x, const auto& y) { EXPECT_TRUE(x == y); });
    EXPECT_EQ(a.blocks()[k].bounds.min(), b.blocks()[k].bounds.min());
    EXPECT_EQ(a.blocks()[k].bounds.max(), b.blocks()[k].bounds.max());
  }
}

void expectSound(const SurfelMap& map) {
  for (const SurfelBlock& block : map.blocks()) {
    const SurfelArrays& s = block.surfels;
    for (std::size_t i = 0; i < s.size(); ++i) {
      ASSERT_TRUE(block.bounds.contains(Eigen::Vector3f(s.x[i], s.y[i], s.z[i])));
      ASSERT_LE(s.radius[i], block.largest_radius);
    }
  }
}

TEST(Deform, TheIdentityLeavesAllBits) {
  const SurfelMap before = deformable(wall());
  SurfelMap map = before;
  deform(map, Deformation());
  deform(map, everything(Eigen::Isometry3d::Identity()));
  expectEqual(map, before);
}

TEST(Deform, WhatWasMadeWhereNothingMovesKeepsItsBitsAndItsBlock) {
  const SurfelMap before = deformable(wall());
  SurfelMap map = before;
  deform(map, bend());
  for (std::size_t k = 0; k < before.blocks().size(); ++k) {
    const SurfelArrays &old = before.blocks()[k].surfels, &now = map.blocks()[k].surfels;
    for (std::size_t i = 0, j = 0; i < old.size(); ++i) {
      if (old.created[i] > 40) continue;
      while (j < now.size() && now.created[j] > 40) ++j;
      ASSERT_LT(j, now.size());
      EXPECT_TRUE(old.x[i] == now.x[j] && old.z[i] == now.z[j] && old.nx[i] == now.nx[j]);
      ++j;
    }
  }
}

TEST(Deform, BlocksOlderThanWhatMovesAreLeftAsIfTheyHadBeenLookedAt) {
  // Filled frame by frame, as a camera does it: what was seen first was changed last long ago.
  const SurfelArrays all = wall();
  SurfelMap map = deformable({});
  map.clear();
  for (int frame = 0; frame < kFrames; ++frame) {
    map.advance();
    std::vector<std::uint32_t> made;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all.created[i] == frame) made.push_back(static_cast<std::uint32_t>(i));
    }
    SurfelArrays some;
    some.append(all, made.data(), made.size());
    map.add(some);
  }
  const auto old = std::count_if(map.blocks().begin(), map.blocks().end(),
                                 [](const SurfelBlock& block) { return block.changed < 40; });
  ASSERT_GT(old, 0);
  SurfelMap whole = deformable(all);  // all its blocks are new
  deform(map, bend());
  deform(whole, bend());
  expectEqual(map, whole);
}

TEST(Deform, OneFragmentJoinsAnotherAndThatStays) {
  // The same surfels in fragments 0, 1 and 2; 2 becomes part of 1. Frames belong to all of them.
  for (const Eigen::Isometry3d& T : {Eigen::Isometry3d::Identity(), motion(0.9, -0.2, 0.1, 0.4)}) {
    SurfelMap map = deformable(wall());
    map.add(wall(), 1);
    map.add(wall(), 2);
    const SurfelMap before = map;
    const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
    deform(map, Deformation(1, {{0, still, true, 0}, {0, still, true, 1}, {50, T, false, 2}},
                            Deformation::Join{2, 1}));
    EXPECT_EQ(map.size(), before.size());
    std::size_t joined = 0;
    map.forEachSurfelOf(2, [](const SurfelArrays&, std::size_t) { FAIL(); });
    map.forEachSurfelOf(1, [&](const SurfelArrays&, std::size_t) { ++joined; });
    EXPECT_EQ(joined, 2 * wall().size());
    for (std::size_t k = 0; k < before.blocks().size(); ++k) {
      const SurfelBlock &old = before.blocks()[k], &now = map.blocks()[k];
      if (old.fragment == 0) {
        EXPECT_EQ(old.surfels.x, now.surfels.x);
      }
      if (old.fragment != 1) continue;
      ASSERT_GE(now.surfels.size(), old.surfels.size());
      for (std::size_t i = 0; i < old.surfels.size(); ++i) {
        EXPECT_EQ(old.surfels.x[i], now.surfels.x[i]);
      }
    }
    double sum = 0;  // of the x of what came
    map.forEachSurfelOf(1, [&](const SurfelArrays& s, std::size_t i) { sum += s.x[i]; });
    double expected = 0;
    const SurfelArrays all = wall();
    for (std::size_t i = 0; i < all.size(); ++i) {
      expected += all.x[i] + (T * Eigen::Vector3d(all.x[i], all.y[i], all.z[i])).x();
    }
    EXPECT_NEAR(sum, expected, 0.05);
    expectSound(map);
  }
}

TEST(Deform, EachSurfelGoesWithTheFrameThatMadeIt) {
  const SurfelArrays before = wall();
  SurfelMap map = deformable(before);
  deform(map, bend());
  EXPECT_EQ(map.size(), before.size());
  std::vector<std::vector<std::size_t>> made(kFrames);
  for (std::size_t i = 0; i < before.size(); ++i) {
    made[static_cast<std::size_t>(before.created[i])].push_back(i);
  }
  map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    const Eigen::Isometry3f T = bend().at(s.created[i]).cast<float>();
    const Eigen::Vector3f p(s.x[i], s.y[i], s.z[i]), n(s.nx[i], s.ny[i], s.nz[i]);
    double nearest = 1;
    for (const std::size_t k : made[static_cast<std::size_t>(s.created[i])]) {
      const Eigen::Vector3f q(before.x[k], before.y[k], before.z[k]);
      const Eigen::Vector3f m(before.nx[k], before.ny[k], before.nz[k]);
      nearest =
          std::min(nearest, static_cast<double>((T * q - p).norm() + (T.linear() * m - n).norm()));
    }
    ASSERT_LT(nearest, 1e-5);
  });
  expectSound(map);
}

TEST(Deform, ARigidOneShowsTheSameFromTheMovedCamera) {
  const SurfelMap before = deformable(wall());
  SurfelMap map = before;
  const Eigen::Isometry3d T = motion(3.1, -0.7, 1.3, 0.8);
  deform(map, everything(T));
  SurfelRenderer renderer;
  ModelView old, now;
  renderer.render(before, smallCamera(), Eigen::Isometry3d::Identity(), {}, old);
  renderer.render(map, smallCamera(), T, {}, now);
  int seen = 0, close = 0;
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) {
      if (old.depth_m.at<float>(v, u) == 0) continue;
      ++seen;
      close += std::abs(old.depth_m.at<float>(v, u) - now.depth_m.at<float>(v, u)) < 1e-3 &&
                       std::abs(old.normal_x.at<float>(v, u) - now.normal_x.at<float>(v, u)) < 1e-2
                   ? 1
                   : 0;
    }
  }
  EXPECT_GT(seen, 8000);
  EXPECT_GT(close, seen * 99 / 100);  // rounding may choose another disc here and there
  expectSound(map);
}

TEST(Deform, IsTheSameForAnyNumberOfThreads) {
  std::vector<SurfelMap> maps;
  for (const int threads : {1, 2, 4}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                              static_cast<std::size_t>(threads));
    maps.push_back(deformable(wall()));
    deform(maps.back(), bend());
  }
  expectEqual(maps[0], maps[1]);
  expectEqual(maps[0], maps[2]);
}

TEST(Deform, KeepsTheLimitOfMemory) {
  SurfelArrays surfels = wall();
  SurfelMap map = deformable(surfels, 1.0);
  const std::size_t before = map.size() + map.refused();
  EXPECT_EQ(before, surfels.size());
  for (int i = 0; i < 3; ++i) {
    // Torn into many pieces, each in blocks of its own.
    std::vector<Deformation::Node> nodes;
    for (int k = 0; k < kFrames; ++k) nodes.push_back({k, motion(0.7 * k, 0, 0.3 * i, 0), false});
    deform(map, Deformation(i + 1, nodes));
    EXPECT_LE(map.memory(), std::size_t{1} << 20);
    EXPECT_EQ(map.size() + map.refused(), before);
    EXPECT_GT(map.size(), 1000U);
  }
  expectSound(map);
}

TEST(Deform, OfAnEmptyMapDoesNothing) {
  SurfelMap map((MapConfig()));
  deform(map, bend());
  EXPECT_EQ(map.size(), 0U);
}

}  // namespace
}  // namespace pf

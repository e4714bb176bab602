// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/layers.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>
#include <set>

namespace pf {
namespace {

constexpr int kSide = 40;

/// Adds a wall z = `z` of kSide x kSide surfels a centimetre apart, made in one frame.
void addWall(SurfelArrays& s, float z, int created, bool away = false, float frames = 20) {
  for (int k = 0; k < kSide * kSide; ++k) {
    s.forEachArray([](auto& array) { array.push_back(0); });
    s.x.back() = 0.01F * static_cast<float>(k % kSide);
    s.y.back() = 0.01F * static_cast<float>(k / kSide);
    s.z.back() = z;
    s.nz.back() = away ? 1.0F : -1.0F;
    s.radius.back() = 0.008F;
    s.odds.back() = frames * static_odds::kFrame;
    s.created.back() = created;
  }
}

/// Surfels of all sizes and ages around a plane, about as it is; a number is its colour.
SurfelArrays scattered(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0.0F, 0.6F), off(-0.08F, 0.08F), tilt(-0.7F, 0.7F),
      part(0.0F, 1.0F);
  SurfelArrays s;
  for (int k = 0; k < count; ++k) {
    s.forEachArray([](auto& array) { array.push_back(0); });
    s.x.back() = place(random);
    s.y.back() = place(random);
    s.z.back() = 2.0F + 0.3F * s.x.back() + off(random);
    const Eigen::Vector3f n = Eigen::Vector3f(tilt(random), tilt(random), -1).normalized();
    s.nx.back() = n.x();
    s.ny.back() = n.y();
    s.nz.back() = n.z();
    s.radius.back() = 0.001F * std::pow(60.0F, part(random));
    s.odds.back() = 20 * static_odds::kFrame;
    s.created.back() = static_cast<int>(1000 * part(random));
    s.r.back() = static_cast<float>(k);
  }
  return s;
}

/// Of each pair of surfels it is asked whether the one is a layer of the other.
std::multiset<float> leftByComparingAll(const SurfelArrays& s) {
  std::multiset<float> left;
  const auto placeOf = [&](std::size_t i) { return Eigen::Vector3f(s.x[i], s.y[i], s.z[i]); };
  const auto normalOf = [&](std::size_t i) { return Eigen::Vector3f(s.nx[i], s.ny[i], s.nz[i]); };
  for (std::size_t i = 0; i < s.size(); ++i) {
    bool goes = false;
    for (std::size_t k = 0; k < s.size() && !goes; ++k) {
      const float cosine = normalOf(k).dot(normalOf(i));
      const float at = normalOf(k).dot(placeOf(k) - placeOf(i)) / cosine;
      const float beside = (placeOf(i) + at * normalOf(i) - placeOf(k)).norm();
      goes = s.created[k] < s.created[i] && cosine >= 0.8F && beside <= s.radius[k] &&
             std::abs(at) >= kLeastLayer_m && std::abs(at) <= kMostLayer_m;
    }
    if (!goes) left.insert(s.r[i]);
  }
  return left;
}

/// The frames in which the surfels were made that stay.
std::multiset<int> left(const SurfelArrays& surfels) {
  SurfelMap map{MapConfig{}};
  map.restore({{kFirstFragment, surfels}}, 1000);
  const std::size_t removed = removeYoungerLayers(map);
  EXPECT_EQ(removed, surfels.size() - map.size());
  const SurfelArrays all = map.collect();
  return {all.created.begin(), all.created.end()};
}

TEST(Layers, TheYoungerGoes) {
  for (const float apart : {0.03F, -0.03F, 0.09F}) {
    SurfelArrays surfels;
    addWall(surfels, 2.0F + apart, 500);
    addWall(surfels, 2.0F, 10);
    const auto made = left(surfels);
    EXPECT_EQ(made.size(), static_cast<std::size_t>(kSide * kSide)) << apart;
    EXPECT_EQ(made.count(500), 0U) << apart;
  }
}

TEST(Layers, OtherFragmentsHaveNoneInCommon) {
  SurfelArrays younger, older;
  addWall(younger, 2.03F, 500);
  addWall(older, 2.0F, 10);
  SurfelMap map{MapConfig{}};
  map.restore({{0, older}, {1, younger}}, 1000);
  EXPECT_EQ(removeYoungerLayers(map), 0U) << "how they lie to each other is not known";
  map.restore({{1, older}, {0, younger}, {1, younger}}, 1000);
  EXPECT_EQ(removeYoungerLayers(map), younger.size());
}

TEST(Layers, OfSomeBlocksThoseThatTheyHaveWithAnyOther) {
  SurfelArrays older, younger;
  addWall(older, 2.0F, 10);
  addWall(younger, 2.03F, 500);
  for (const int lower : {0, 1}) {
    SurfelMap map{MapConfig{}};
    map.restore({{0, lower == 0 ? older : younger}}, 1000);
    const auto first = static_cast<std::uint32_t>(map.blocks().size());
    // Beside each other in the same cubes, as after a correction.
    map.add(lower == 0 ? younger : older, 1);
    map.move({[](const SurfelBlock&) { return false; }, [](SurfelArrays&, int) {},
              [](int) { return 0; }},
             allBlocks(map));
    ASSERT_GT(map.blocks().size(), first);
    SurfelMap named = map, all = map;
    std::vector<std::uint32_t> of_second = allBlocks(map);
    of_second.erase(of_second.begin(), of_second.begin() + first);
    EXPECT_EQ(removeYoungerLayers(named, {}), 0U);
    EXPECT_EQ(removeYoungerLayers(named, of_second), younger.size()) << lower;
    EXPECT_EQ(removeYoungerLayers(all), younger.size());
    EXPECT_EQ(named.collect().x, all.collect().x);
  }
}

TEST(Layers, WhatReachesBeyondTheOlderStays) {
  SurfelArrays surfels;
  addWall(surfels, 2.0F, 10);
  SurfelArrays beside;
  addWall(beside, 2.04F, 500);
  for (float& x : beside.x) x += 0.2F;  // half of it lies behind the older
  addWall(surfels, 2.04F, 500);
  surfels.resize(kSide * kSide);
  std::vector<std::uint32_t> all(beside.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  surfels.append(beside, all.data(), all.size());
  EXPECT_EQ(left(surfels).count(500), static_cast<std::size_t>(kSide * kSide / 2));
}

TEST(Layers, NoiseOtherSurfacesAndUnstableSurfelsStay) {
  const auto stays = [](float apart, bool away, float older_frames) {
    SurfelArrays surfels;
    addWall(surfels, 2.0F, 10, false, older_frames);
    addWall(surfels, 2.0F + apart, 500, away);
    return left(surfels).size() == surfels.size();
  };
  EXPECT_FALSE(stays(0.03F, false, 20));
  EXPECT_TRUE(stays(0.01F, false, 20)) << "noise of one layer";
  EXPECT_TRUE(stays(0.11F, false, 20)) << "a surface of its own";
  EXPECT_TRUE(stays(0.03F, true, 20)) << "the other side of a board";
  EXPECT_TRUE(stays(0.03F, false, 2)) << "the older was hardly seen";
}

TEST(Layers, OfOneFrameBothStay) {
  SurfelArrays surfels;
  addWall(surfels, 2.0F, 10);
  addWall(surfels, 2.04F, 10);
  EXPECT_EQ(left(surfels).size(), surfels.size()) << "one frame saw both";
}

TEST(Layers, OfAllSizesNoneIsMissed) {
  const SurfelArrays surfels = scattered(4000);
  SurfelMap map{MapConfig{}};
  map.restore({{kFirstFragment, surfels}}, 1000);
  removeYoungerLayers(map);
  const SurfelArrays all = map.collect();
  EXPECT_GT(all.size(), 100U);
  EXPECT_LT(all.size(), 3900U);
  EXPECT_EQ(std::multiset<float>(all.r.begin(), all.r.end()), leftByComparingAll(surfels));
}

TEST(Layers, ThreadsDoNotMatter) {
  SurfelArrays surfels;
  addWall(surfels, 2.0F, 10);
  addWall(surfels, 2.03F, 400);
  addWall(surfels, 2.11F, 700);  // a layer of the second, which goes
  const auto many = left(surfels);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(left(surfels), many);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/map_append.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "posefusion/core/error.hpp"
#include "posefusion/graph/pose_graph.hpp"

namespace pf {
namespace {

/// Two keyframes in as many fragments, a surfel in each, and a retired one.
SavedMap mapOf(int frame) {
  SavedMap map;
  map.frame = frame;
  map.graph_version = 2;
  for (int i = 0; i < 2; ++i) {
    Keyframe k;
    k.id = k.fragment = i;
    k.map_frame = i * frame;
    map.keyframes.push_back(k);
    FragmentSurfels part;
    part.fragment = i;
    part.surfels.resize(1);
    part.surfels.created[0] = i * frame;
    part.surfels.seen[0] = frame;
    map.surfels.push_back(part);
    map.frames.push_back({100 + i, {i, Eigen::Isometry3d::Identity()}});
    KeyframeView view;
    view.id = view.pose.fragment = i;
    map.views.push_back(view);
  }
  Keyframe retired = map.keyframes[1];
  retired.id = 2;
  retired.follows = 1;
  map.keyframes.push_back(retired);
  PoseConstraint tie;
  tie.from = 0;
  tie.to = 1;
  map.constraints.push_back(tie);
  return map;
}

TEST(MapAppend, TheSecondHasTheNumbersThatComeNext) {
  SavedMap first = mapOf(9);
  first.T_world_map = Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3));
  first.brightness.gain = 2;
  const SavedMap both = appended(first, mapOf(4));
  EXPECT_EQ(both.frame, 14) << "10 frames and 5";
  EXPECT_EQ(both.graph_version, 4);
  EXPECT_EQ(both.brightness.gain, 1) << "of the frame that was seen last";
  EXPECT_EQ(both.T_world_map->translation(), first.T_world_map->translation());
  ASSERT_EQ(both.keyframes.size(), 6U);
  ASSERT_EQ(both.surfels.size(), 4U);
  for (std::size_t i = 0; i < 2; ++i) {
    const int number = static_cast<int>(i);
    const Keyframe& k = both.keyframes[i + 3];
    EXPECT_EQ(k.id, number + 3);
    EXPECT_EQ(k.fragment, number + 2);
    EXPECT_EQ(k.map_frame, 10 + 4 * number);
    EXPECT_EQ(both.surfels[i + 2].fragment, k.fragment);
    EXPECT_EQ(both.surfels[i + 2].surfels.created[0], k.map_frame);
    EXPECT_EQ(both.surfels[i + 2].surfels.seen[0], 14);
    EXPECT_EQ(both.frames[i + 2].pose.keyframe, k.id);
    EXPECT_EQ(both.views[i + 2].id, k.id);
    EXPECT_EQ(both.views[i + 2].pose.fragment, k.fragment);
  }
  EXPECT_EQ(both.keyframes[2].follows, 1);
  EXPECT_EQ(both.keyframes[5].follows, 4);
  EXPECT_EQ(both.constraints[1].from, 3);
  EXPECT_EQ(both.constraints[1].to, 4);
  const PoseGraph graph({}, both.keyframes, both.constraints, both.graph_version);
  EXPECT_EQ(graph.keyframes().size(), 6U) << "it is a graph";
}

TEST(MapAppend, TheCalibrationFromMorePairsIsKept) {
  SavedMap none = mapOf(1), few = none, many = none;
  few.calibration.emplace().pairs = 50;
  many.calibration.emplace().pairs = 500;
  EXPECT_FALSE(appended(none, none).calibration);
  EXPECT_EQ(appended(none, few).calibration->pairs, 50U);
  EXPECT_EQ(appended(few, none).calibration->pairs, 50U);
  EXPECT_EQ(appended(few, many).calibration->pairs, 500U);
  EXPECT_EQ(appended(many, few).calibration->pairs, 500U);
}

TEST(MapAppend, WhatCannotBeCountedIsRefused) {
  SavedMap huge = mapOf(1), far = mapOf(1);
  huge.frame = std::numeric_limits<int>::max() - 1;
  EXPECT_THROW(appended(huge, mapOf(1)), InputError);
  EXPECT_THROW(appended(mapOf(1), huge), InputError);
  far.surfels[0].fragment = std::numeric_limits<int>::max();
  EXPECT_THROW(appended(far, mapOf(1)), InputError);
  EXPECT_THROW(appended(mapOf(1), far), InputError);
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/map_merge.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <map>

#include "posefusion/core/error.hpp"
#include "posefusion/slam/loop_thread.hpp"
#include "posefusion/slam/map_append.hpp"
#include "posefusion/slam/mapper.hpp"
#include "simulated_sequence.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

constexpr int kFrames = 120, kMiddle = 60, kOverlap = 35;

const SimulatedSequence& room() { return exactBox<kFrames>(); }

Config config() {
  Config c;
  c.frame.shrink = 1;                  // the images are small already
  c.graph.keyframe_distance_m = 0.08;  // so that there are some
  c.graph.keyframe_angle_rad = 0.08;
  return c;
}

/// A recording of its own of some frames, that begins at its first camera.
SavedMap mapped(const SimulatedSequence& seen, int begin, int end) {
  Mapper mapper(config());
  for (int i = begin; i < end; ++i) mapper.process({seen.frame(i).frame, {}, {}});
  return mapper.saved(seen.frame(0).frame.camera);
}

const SavedMap& firstHalf() {
  static const SavedMap map = mapped(room(), 0, kMiddle + kOverlap);
  return map;
}
const SavedMap& secondHalf() {
  static const SavedMap map = mapped(room(), kMiddle, kFrames);
  return map;
}

/// The same room from the other side, another part of it.
const SavedMap& elsewhere() {
  static const SavedMap map = [] {
    const SimulatedSequence other(
        "empty_box", 15,
        {"depth.distortion=0", "camera.at_m=[3.2,1.6,1.35]", "camera.look_at_m=[0.2,1.2,1.2]"});
    return mapped(other, 0, 15);
  }();
  return map;
}

/// The map with a piece beside it that nothing joins to the rest.
SavedMap withPiece(const SavedMap& map) { return appended(map, elsewhere()); }

/// Of all poses of fragment 0 against the truth (m, RMS); `first`: the frame at the map's origin.
double errorM(const SavedMap& map, int first) {
  std::map<std::int64_t, int> index;
  for (int i = 0; i < kFrames; ++i) index[room().stamp(i)] = i;
  double sum = 0;
  std::size_t count = 0;
  for (const FrameRecord& frame : map.frames) {
    if (map.keyframes[static_cast<std::size_t>(frame.pose.keyframe)].fragment != 0) continue;
    const Eigen::Isometry3d T = room().pose(first) * poseOf(frame.pose, map.keyframes);
    sum += (T.translation() - room().pose(index.at(frame.stamp_ns)).translation()).squaredNorm();
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(count));
}

MergedMap merged(const SavedMap& first, const SavedMap& second) {
  return merge({"one", first}, {"two", second}, config());
}

const MergedMap& bothHalves() {
  static const MergedMap map = merged(firstHalf(), secondHalf());
  return map;
}

std::string refusal(const SavedMap& first, const SavedMap& second) {
  return errorOf([&] { merged(first, second); });
}

SurfelArrays all(const SavedMap& map) {
  SurfelArrays surfels;
  for (const FragmentSurfels& part : map.surfels) surfels.append(part.surfels);
  return surfels;
}

TEST(MapMerge, TwoHalvesOfAWalkBecomeOneMap) {
  const MergedMap& both = bothHalves();
  EXPECT_EQ(both.apart, 0U);
  EXPECT_GE(both.loops, 3U);
  EXPECT_LE(both.agreeing, both.recognised);
  ASSERT_EQ(both.map.frames.size(), firstHalf().frames.size() + secondHalf().frames.size());
  const double worst_m = std::max(errorM(firstHalf(), 0), errorM(secondHalf(), kMiddle));
  EXPECT_LT(errorM(both.map, 0), 1.3 * worst_m + 0.002);
  for (const Keyframe& k : both.map.keyframes) EXPECT_EQ(k.fragment, kFirstFragment);
}

TEST(MapMerge, TheFirstStaysWhereItIs) {
  SavedMap first = firstHalf();
  first.T_world_map = Eigen::Translation3d(1, 2, 3) * bodyFromOptical();
  const MergedMap both = merged(first, secondHalf());
  EXPECT_EQ(both.map.T_world_map->matrix(), first.T_world_map->matrix());
  EXPECT_EQ(both.map.keyframes[0].T_map_camera.matrix(), first.keyframes[0].T_map_camera.matrix());
  for (std::size_t i = 0; i < first.keyframes.size(); ++i) {
    const Keyframe &before = first.keyframes[i], &after = both.map.keyframes[i];
    EXPECT_EQ(after.stamp_ns, before.stamp_ns);
    EXPECT_EQ(after.map_frame, before.map_frame);
    EXPECT_LT((after.T_map_camera.translation() - before.T_map_camera.translation()).norm(), 0.01);
  }
}

TEST(MapMerge, SurfelsKeepTheFrameThatMadeThem) {
  const MergedMap& both = bothHalves();
  const SurfelArrays surfels = all(both.map);
  EXPECT_EQ(both.map.frame, firstHalf().frame + 1 + secondHalf().frame);
  EXPECT_EQ(surfels.size() + both.layers,
            surfelsIn(firstHalf().surfels) + surfelsIn(secondHalf().surfels));
  const auto behind = [&](std::int32_t frame) { return frame > firstHalf().frame; };
  const auto of_second = std::count_if(surfels.created.begin(), surfels.created.end(), behind);
  EXPECT_LE(static_cast<std::size_t>(of_second), surfelsIn(secondHalf().surfels));
  EXPECT_GT(of_second, 0);
  EXPECT_LE(*std::max_element(surfels.seen.begin(), surfels.seen.end()), both.map.frame);
}

TEST(MapMerge, TheOtherWayRoundItIsTheSameMapFromAnotherOrigin) {
  const MergedMap one = merged(firstHalf(), secondHalf()),
                  other = merged(secondHalf(), firstHalf());
  EXPECT_EQ(other.map.frames.size(), one.map.frames.size());
  EXPECT_NEAR(static_cast<double>(other.recognised), static_cast<double>(one.recognised),
              0.5 * static_cast<double>(one.recognised));
  EXPECT_NEAR(errorM(other.map, kMiddle), errorM(one.map, 0), 0.005);
}

TEST(MapMerge, AMapWithItselfIsItself) {
  const MergedMap both = merged(firstHalf(), firstHalf());
  EXPECT_EQ(both.apart, 0U);
  EXPECT_LT(errorM(both.map, 0), errorM(firstHalf(), 0) + 0.005);
  const std::size_t border = firstHalf().keyframes.size();
  ASSERT_EQ(both.map.keyframes.size(), 2 * border);
  for (std::size_t i = 0; i < border; ++i) {
    const Eigen::Isometry3d step =
        both.map.keyframes[i].T_map_camera.inverse() * both.map.keyframes[i + border].T_map_camera;
    EXPECT_LT(step.translation().norm(), 0.01) << "keyframe " << i;
  }
}

TEST(MapMerge, APlaceThatOneHasNotSeenIsRefused) {
  const std::string reason = refusal(firstHalf(), elsewhere());
  EXPECT_EQ(reason.rfind("two does not become one with one: ", 0), 0U) << reason;
  EXPECT_NE(reason.find("recognised"), std::string::npos) << reason;
}

TEST(MapMerge, OneCommonPictureIsTooLittle) {
  SavedMap second = secondHalf();
  // The pictures of the others are not known.
  second.views.resize(1);
  const std::string reason = refusal(firstHalf(), second);
  EXPECT_NE(reason.find("too little was recognised: 1 places agree"), std::string::npos) << reason;
}

TEST(MapMerge, WhatContradictsItselfIsRefused) {
  // Tracking has jumped by a metre without notice.
  SavedMap broken = firstHalf();
  const std::size_t middle = broken.keyframes.size() / 2;
  const Eigen::Isometry3d jump(Eigen::Translation3d(0, 0, 1));
  for (std::size_t i = middle; i < broken.keyframes.size(); ++i) {
    Keyframe& k = broken.keyframes[i];
    k.T_map_camera = jump * k.T_map_camera;
  }
  for (PoseConstraint& c : broken.constraints) {
    const auto pose = [&](int i) {
      return broken.keyframes[static_cast<std::size_t>(i)].T_map_camera;
    };
    c.T_from_to = pose(c.from).inverse() * pose(c.to);
  }
  const std::string reason = refusal(firstHalf(), broken);
  EXPECT_NE(reason.find("what was recognised is contradictory"), std::string::npos) << reason;
}

TEST(MapMerge, WithoutPicturesNothingIsRecognised) {
  SavedMap blind = firstHalf();
  blind.views.clear();
  EXPECT_NE(refusal(blind, secondHalf()).find("nothing of the second was recognised"),
            std::string::npos);
  EXPECT_NE(refusal(secondHalf(), blind).find("nothing of the second was recognised"),
            std::string::npos);
}

TEST(MapMerge, MapsOfOtherCamerasAreRefused) {
  SavedMap second = secondHalf();
  second.camera.fx += 5;
  const std::string reason = refusal(firstHalf(), second);
  EXPECT_NE(reason.find("they are of different cameras"), std::string::npos) << reason;
}

TEST(MapMerge, WhatIsNoMapIsNamed) {
  SavedMap empty = secondHalf();
  empty.keyframes.clear();
  EXPECT_EQ(refusal(firstHalf(), empty), "two: has no keyframe: nothing was mapped");
  EXPECT_EQ(refusal(empty, firstHalf()), "one: has no keyframe: nothing was mapped");
}

TEST(MapMerge, FragmentsOfEitherStayAsTheyAreUnlessTheyAreRecognised) {
  // Both have a piece of another part of the room, whose place in it is not known.
  const SavedMap first = withPiece(firstHalf()), second = withPiece(secondHalf());
  const MergedMap both = merged(first, second);
  std::map<int, std::size_t> keyframes;
  for (const Keyframe& k : both.map.keyframes) ++keyframes[k.fragment];
  EXPECT_EQ(keyframes.size(), 2U) << "the pieces that are of one place are joined as well";
  EXPECT_EQ(keyframes.begin()->first, kFirstFragment);
  EXPECT_EQ(keyframes.begin()->second,
            firstHalf().keyframes.size() + secondHalf().keyframes.size());
  EXPECT_EQ(both.apart, 0U);
  const MergedMap one = merged(firstHalf(), second);
  EXPECT_EQ(one.apart, 1U);
  EXPECT_LT(errorM(one.map, 0), errorM(bothHalves().map, 0) + 0.001);
}

TEST(MapMerge, MappingGoesOnInIt) {
  Mapper mapper(config());
  LoopThread closer(config(), AnswerTime::after_lag);
  SavedMap map = bothHalves().map;
  const std::size_t surfels = surfelsIn(map.surfels), keyframes = map.keyframes.size();
  mapper.load(std::move(map), MapUse::extend);
  int right = 0;
  constexpr int kBegin = kMiddle - 20, kEnd = kMiddle + 30;
  for (int i = kBegin; i < kEnd; ++i) {
    const FrameStatus status = mapper.process({room().frame(i).frame, {}, {}});
    closer.serve(mapper);
    if (!status.located) continue;
    EXPECT_LT((status.T_map_camera.translation() - room().pose(i).translation()).norm(), 0.03) << i;
    ++right;
  }
  EXPECT_GT(right, (kEnd - kBegin) / 2);
  EXPECT_GT(mapper.backEnd().graph().keyframes().size(), keyframes);
  EXPECT_LT(mapper.map().size(), 2 * surfels);
}

TEST(MapMerge, IsTheSameForOneThread) {
  const MergedMap& many = bothHalves();
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  const MergedMap one = merged(firstHalf(), secondHalf());
  EXPECT_EQ(many.text(), one.text());
  const SurfelArrays b = all(one.map);
  all(many.map).forEachArray(b, [](const auto& x, const auto& y) { EXPECT_EQ(x, y); });
  ASSERT_EQ(many.map.keyframes.size(), one.map.keyframes.size());
  for (std::size_t i = 0; i < one.map.keyframes.size(); ++i) {
    EXPECT_EQ(many.map.keyframes[i].T_map_camera.matrix(),
              one.map.keyframes[i].T_map_camera.matrix());
  }
}

}  // namespace
}  // namespace pf

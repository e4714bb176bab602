// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion_ros/parent_watch.hpp"

#include <gtest/gtest.h>

namespace posefusion_ros {
namespace {

using std::chrono::seconds;

const ParentWatch::Time kNow;

TEST(ParentWatch, OurOwnTransformIsNoConflict) {
  ParentWatch watch;
  EXPECT_EQ(watch.conflict("camera", "map", "/me", kNow), "") << "it has no sender";
  watch.hear("camera", "map", "/me", false, kNow);
  watch.hear("other_camera", "map", "/you", false, kNow);
  EXPECT_EQ(watch.conflict("camera", "map", "/me", kNow), "");
}

TEST(ParentWatch, AnotherParentOrSenderIs) {
  ParentWatch watch;
  watch.hear("camera", "map", "/me", false, kNow);
  watch.hear("camera", "left_map", "/you", false, kNow);
  const std::string said = watch.conflict("camera", "map", "/me", kNow);
  EXPECT_EQ(said, "frame camera has the parent left_map already, sent by /you");
  ParentWatch same_frames;
  same_frames.hear("camera", "map", "/you", false, kNow);
  EXPECT_NE(same_frames.conflict("camera", "map", "/me", kNow), "");
}

TEST(ParentWatch, ASenderThatHasStoppedIsForgottenButAFixedTransformHolds) {
  ParentWatch watch;
  watch.hear("camera", "left_map", "/you", false, kNow);
  EXPECT_EQ(watch.conflict("camera", "map", "/me", kNow + seconds(3)), "");
  watch.hear("camera", "camera_link", "/driver", true, kNow);
  EXPECT_NE(watch.conflict("camera", "map", "/me", kNow + seconds(3)), "");
}

TEST(ParentWatch, TheFrameToGiveIsTheTopOfTheOthersTree) {
  ParentWatch watch;
  EXPECT_EQ(watch.rootAbove("camera", "map", "/me"), "camera");
  watch.hear("camera", "camera_rgb", "/driver", true, kNow);
  watch.hear("camera_rgb", "camera_link", "/driver", true, kNow);
  EXPECT_EQ(watch.rootAbove("camera", "map", "/me"), "camera_link");
  watch.hear("camera_link", "map", "/me", false, kNow);
  EXPECT_EQ(watch.rootAbove("camera", "map", "/me"), "camera_link") << "our own does not count";
}

TEST(ParentWatch, ARingOfParentsHasAnEnd) {
  ParentWatch watch;
  watch.hear("a", "b", "/you", true, kNow);
  watch.hear("b", "a", "/you", true, kNow);
  watch.rootAbove("a", "map", "/me");
}

}  // namespace
}  // namespace posefusion_ros

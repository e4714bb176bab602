// SPDX-License-Identifier: BSD-3-Clause
// Durations are the same at any frame rate.
#include "posefusion/core/pace.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "fusion_scene.hpp"
#include "mapper_scene.hpp"
#include "posefusion/map/render.hpp"
#include "posefusion/slam/localiser.hpp"

namespace pf {
namespace {

constexpr double kRates_hz[] = {10.0, 15.0, 25.0, 60.0};

std::int64_t stampAt(int i, double rate_hz) {
  return 1000000000 + static_cast<std::int64_t>(1e9 * i / rate_hz);
}

Pace paceOf(double rate_hz) { return {1.0 / rate_hz}; }

/// How long (s) it takes until `done`, called for each frame, returns true; at most five seconds.
double secondsUntil(double rate_hz, const std::function<bool()>& done) {
  int frames = 1;
  while (!done() && frames < 5 * rate_hz) ++frames;
  return frames / rate_hz;
}

/// `seconds`, measured at a rate, lasts as long at others, to a frame of each.
void expectTheSameAtAnyRate(const std::function<double(double)>& seconds) {
  const double usual_s = seconds(Pace::kUsual_hz);
  EXPECT_LT(usual_s, 5.0);
  for (const double rate_hz : kRates_hz) {
    EXPECT_NEAR(seconds(rate_hz), usual_s, 1.0 / rate_hz + 1.0 / Pace::kUsual_hz) << rate_hz;
  }
}

/// How long (s) a scene is fused, after `before_s` of another one, until the map is as required.
double secondsOfChange(double rate_hz, WorkingFrame before, double before_s, WorkingFrame after,
                       const std::function<bool(const SurfelMap&)>& done) {
  SurfelMap map{MapConfig{}};
  before.pace = after.pace = paceOf(rate_hz);
  fuseOften(before.pace.framesIn(before_s), before, map);
  return secondsUntil(rate_hz, [&] {
    fuseOften(1, after, map);
    return done(map);
  });
}

TEST(Pace, CountsThirtyFramesInASecondAtTheUsualRate) {
  EXPECT_EQ(Pace().framesIn(1.0), 30);
  EXPECT_EQ(Pace().worth(), 1.0F);
  EXPECT_EQ(paceOf(60.0).framesIn(0.1), 6);
  EXPECT_EQ(paceOf(10.0).worth(), 3.0F);
  EXPECT_EQ(paceOf(60.0).worth(), 0.5F);
}

TEST(Pace, CountsAtLeastOneFrameAndNoMoreThanAnIntegerHolds) {
  EXPECT_EQ(Pace().framesIn(0.0), 1);
  EXPECT_GT(Pace().framesIn(1e9), 1000000);
  EXPECT_GT(paceOf(1000.0).worth(), 0.0F);
}

TEST(PaceMeter, IsThirtyHertzUntilItIsMeasured) {
  PaceMeter meter;
  EXPECT_EQ(meter.add(5).framesIn(1.0), 30);
  EXPECT_EQ(meter.add(5 + 100000000).framesIn(1.0), 10);
}

TEST(PaceMeter, NeitherJitterNorPausesNorBurstsOfBlurChangeThePace) {
  PaceMeter meter;
  Pace pace;
  for (int i = 0; i < 300; ++i) {
    const bool is_blurred = i % 100 > 70 && i % 100 < 95 && i % 6 != 0;
    const std::int64_t jitter_ns = (i % 3 - 1) * 1000000, pause_ns = i > 150 ? 20000000000 : 0;
    if (!is_blurred) pace = meter.add(stampAt(i, 30.0) + jitter_ns + pause_ns);
    EXPECT_EQ(pace.framesIn(1.0 / 3.0), 10) << i;
    EXPECT_EQ(pace.worth(), 1.0F) << i;
  }
}

TEST(PaceMeter, FollowsACameraThatIsSetToAnotherRateOrClock) {
  PaceMeter meter;
  Pace pace;
  for (int i = 0; i < 60; ++i) pace = meter.add(stampAt(i, 30.0));
  for (int i = 121; i < 121 + 30; ++i) pace = meter.add(stampAt(i, 60.0));
  EXPECT_EQ(pace.framesIn(1.0), 60);
  for (int i = 0; i < 3; ++i) pace = meter.add(stampAt(i, 15.0));
  EXPECT_EQ(pace.framesIn(1.0), 15) << "the clock was put back";
}

TEST(PaceOfTheMap, ASurfelIsStableAfterTheSameTime) {
  expectTheSameAtAnyRate([](double rate_hz) {
    SurfelMap map{MapConfig{}};
    WorkingFrame wall = scene(2.0);
    wall.pace = paceOf(rate_hz);
    return secondsUntil(rate_hz, [&] {
      fuseOften(1, wall, map);
      return map.stableCount() > 0;
    });
  });
}

TEST(PaceOfTheMap, WhatComesBeforeAKnownWallIsStableAfterTheSameTime) {
  expectTheSameAtAnyRate([](double rate_hz) {
    return secondsOfChange(rate_hz, scene(3.0), 1.0, scene(3.0, 1.5),
                           [](const SurfelMap& map) { return stableNear(map, 1.5) > 0; });
  });
}

TEST(PaceOfTheMap, FurnitureThatWasMovedGoesAfterTheSameTime) {
  expectTheSameAtAnyRate([](double rate_hz) {
    return secondsOfChange(rate_hz, scene(3.0, 1.5), 2.0, scene(3.0),
                           [](const SurfelMap& map) { return countNear(map, 1.5) < 100; });
  });
}

TEST(PaceOfTheMap, WhatIsNotSeenAgainIsForgottenAfterTheSameTime) {
  expectTheSameAtAnyRate([](double rate_hz) {
    SurfelMap map{MapConfig{}};
    WorkingFrame wall = scene(2.0), nothing = scene(0.0);
    wall.pace = nothing.pace = paceOf(rate_hz);
    fuseOften(1, wall, map);
    const SurfelArrays once = map.collect();
    return secondsUntil(rate_hz, [&] {
      fuseOften(1, nothing, map);
      return map.isDead(once, 0);
    });
  });
}

/// A camera that stands still in a mapped room, and is covered for a while.
class StandingCamera {
 public:
  StandingCamera(const RgbdFrame& seen, double rate_hz) : rate_hz_(rate_hz) {
    FrameConfig config;
    config.shrink = 2;
    open_.assign(seen, cv::Mat(), config);
    RgbdFrame dark = seen;
    dark.depth = cv::Mat(seen.depth.size(), seen.depth.type(), cv::Scalar(0));
    covered_.assign(dark, cv::Mat(), config);
    open_.pace = covered_.pace = paceOf(rate_hz);
    fuseOften(40, open_, map_);
    SurfelRenderer().render(map_, open_.camera, kIdentity, {}, view_);
    points_.assign(view_, open_.sensor);
    localiser_.begin(open_, stampAt(0, rate_hz), {kFirstFragment, kIdentity});
  }

  Location see(bool covered) {
    const MapRenderers render{[&](const Eigen::Isometry3d&) {
                                return RenderedModel{points_, kIdentity};
                              },
                              [&](const Eigen::Isometry3d&) -> const ModelView& { return view_; }};
    return localiser_.locate(covered ? covered_ : open_, stampAt(++frames_, rate_hz_), {}, false,
                             view_, render);
  }
  double untilLost() {
    return secondsUntil(rate_hz_, [&] { return see(true).state == TrackingState::lost; });
  }
  double untilBack() {
    return secondsUntil(rate_hz_, [&] { return see(false).is_return; });
  }
  double onProbation() {
    return secondsUntil(rate_hz_, [&] { return !see(false).is_recent_return; });
  }

 private:
  double rate_hz_;
  int frames_ = 0;
  WorkingFrame open_, covered_;
  SurfelMap map_{MapConfig{}};
  ModelView view_;
  ModelPyramid points_;
  Localiser localiser_{TrackingConfig{}};
};

class PaceOfTheLocaliser : public MapperTest {};

TEST_F(PaceOfTheLocaliser, IsLostAndBackAndOnProbationForTheSameTime) {
  const RgbdFrame seen = room().frame(0).frame;
  expectTheSameAtAnyRate([&](double rate_hz) { return StandingCamera(seen, rate_hz).untilLost(); });
  expectTheSameAtAnyRate([&](double rate_hz) {
    StandingCamera camera(seen, rate_hz);
    camera.untilLost();
    return camera.untilBack();
  });
  expectTheSameAtAnyRate([&](double rate_hz) {
    StandingCamera camera(seen, rate_hz);
    camera.untilLost();
    camera.untilBack();
    return camera.onProbation();
  });
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/camera.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace pf {
namespace {

PinholeCamera camera() { return {640, 480, 525, 526, 319.5, 239.5}; }

TEST(SameCamera, IsOneWrittenDownOnceMore) {
  PinholeCamera other = camera();
  EXPECT_TRUE(isSameCamera(camera(), other));
  other.fx *= 1 + 1e-9;
  other.cy += 1e-6;
  EXPECT_NE(camera(), other);
  EXPECT_TRUE(isSameCamera(camera(), other));
  EXPECT_TRUE(isSameCamera(other, camera()));
}

// fx moves a corner, 320 px from the middle, by 320 / 525 of its change.
TEST(SameCamera, AHundredthOfAPixelAtACornerIsTheLimit) {
  PinholeCamera near = camera(), far = camera();
  near.fx += 0.0155;
  far.fx += 0.0175;
  EXPECT_TRUE(isSameCamera(camera(), near));
  EXPECT_FALSE(isSameCamera(camera(), far));
  PinholeCamera shifted = camera();
  shifted.cx += 0.011;
  EXPECT_FALSE(isSameCamera(camera(), shifted));
}

TEST(SameCamera, IsNoneOfAnotherSizeOrLensOrThatIsNoCamera) {
  PinholeCamera small = camera(), bent = camera(), fisheye = camera(), broken = camera();
  small.height = 479;
  bent.distortion[0] = 0.1;
  fisheye.lens = LensModel::kEquidistant;
  broken.fx = std::numeric_limits<double>::quiet_NaN();
  for (const PinholeCamera& other : {small, bent, fisheye, broken, PinholeCamera()}) {
    EXPECT_FALSE(isSameCamera(camera(), other)) << describe(other);
    EXPECT_FALSE(isSameCamera(other, camera())) << describe(other);
  }
}

TEST(SameCamera, IsDescribedWithAllThatDistinguishesIt) {
  PinholeCamera other = camera();
  other.fx = 525.0175;
  EXPECT_EQ(describe(other), "640 x 480, fx 525.0175 fy 526 cx 319.5 cy 239.5");
}

}  // namespace
}  // namespace pf

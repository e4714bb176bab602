// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/core/one_size.hpp"

#include <gtest/gtest.h>

#include "temporary_folder.hpp"

namespace pf {
namespace {

PinholeCamera camera(int width, int height, double focal_px, double cx, double cy) {
  PinholeCamera c;
  c.width = width;
  c.height = height;
  c.fx = c.fy = focal_px;
  c.cx = cx;
  c.cy = cy;
  return c;
}

/// Colours encode the ray of a pixel: red is the column's direction, green the row's, in 1/200 from
/// -0.6 on. Depth is 1000 + red.
double coded(double slope) { return 200 * (slope + 0.6); }

RgbdFrame frameOf(const PinholeCamera& color, const PinholeCamera& depth) {
  RgbdFrame f;
  f.camera = color;
  f.color.create(color.height, color.width, CV_8UC3);
  for (int v = 0; v < color.height; ++v) {
    for (int u = 0; u < color.width; ++u) {
      const Eigen::Vector3d ray = color.unproject(u, v, 1);
      f.color.at<cv::Vec3b>(v, u) = {static_cast<unsigned char>(std::lround(coded(ray.x()))),
                                     static_cast<unsigned char>(std::lround(coded(ray.y()))), 7};
    }
  }
  f.depth.create(depth.height, depth.width, CV_16UC1);
  for (int v = 0; v < depth.height; ++v) {
    for (int u = 0; u < depth.width; ++u) {
      f.depth.at<std::uint16_t>(v, u) =
          static_cast<std::uint16_t>(std::lround(1000 + coded(depth.unproject(u, v, 1).x())));
    }
  }
  return f;
}

/// Every pixel of both images has to have the ray of the frame's camera, to one large pixel.
void expectRays(const RgbdFrame& f, double tolerance) {
  ASSERT_EQ(defectOf(f), "");
  for (int v = 0; v < f.camera.height; ++v) {
    for (int u = 0; u < f.camera.width; ++u) {
      const Eigen::Vector3d ray = f.camera.unproject(u, v, 1);
      const cv::Vec3b color = f.color.at<cv::Vec3b>(v, u);
      ASSERT_NEAR(color[0], coded(ray.x()), tolerance) << u << " " << v;
      ASSERT_NEAR(color[1], coded(ray.y()), tolerance) << u << " " << v;
      ASSERT_NEAR(f.depth.at<std::uint16_t>(v, u), 1000 + coded(ray.x()), tolerance)
          << u << " " << v;
    }
  }
}

const PinholeCamera kDepth = camera(80, 60, 70, 39.5, 29.5);

TEST(OneSize, EqualSizesPassUntouched) {
  const RgbdFrame f = frameOf(kDepth, kDepth);
  const RgbdFrame out = bringToOneSize(f, kDepth);
  EXPECT_EQ(out.color.data, f.color.data);
  EXPECT_EQ(out.depth.data, f.depth.data);
}

TEST(OneSize, LargeColourTakesThePixelsOfDepth) {
  const RgbdFrame out = bringToOneSize(frameOf(camera(160, 120, 140, 79.5, 59.5), kDepth), kDepth);
  EXPECT_EQ(out.camera, kDepth);
  expectRays(out, 1.1);
}

TEST(OneSize, ColourThatSeesMoreIsCut) {
  // 5:4 colour, depth in its upper part, as the Xtion has it; and a scale that is no integer.
  expectRays(bringToOneSize(frameOf(camera(160, 128, 140, 79.5, 59.5), kDepth), kDepth), 1.1);
  expectRays(bringToOneSize(frameOf(camera(150, 120, 112, 74.5, 55.5), kDepth), kDepth), 2.5);
}

TEST(OneSize, LargeDepthTakesThePixelsOfColour) {
  const PinholeCamera small = camera(40, 30, 35, 19.5, 14.5);
  const RgbdFrame out = bringToOneSize(frameOf(small, kDepth), kDepth);
  EXPECT_EQ(out.camera, small);
  expectRays(out, 2.9);
}

TEST(OneSize, AnotherConventionForTheCentreIsNoDifference) {
  // Drivers scale cx as they scale the width: half a large pixel off.
  EXPECT_NO_THROW(
      bringToOneSize(frameOf(camera(160, 120, 140, 80, 60), kDepth), camera(80, 60, 70, 40, 30)));
}

TEST(OneSize, WhatDoesNotRelateIsRefusedByName) {
  const auto error = [](const PinholeCamera& color, const PinholeCamera& depth) {
    return errorOf([&] { bringToOneSize(frameOf(color, depth), depth); });
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  PinholeCamera color = camera(160, 120, 140, 79.5, 59.5);
  color.fy = 120;
  EXPECT_TRUE(has(error(color, kDepth), "one scale for columns and rows"));
  EXPECT_TRUE(has(error(color, kDepth), "colour is 160x120 (fx 140 fy 120"));
  EXPECT_TRUE(has(error(color, kDepth), "depth is 80x60 (fx 70"));
  color = camera(160, 90, 140, 79.5, 44.5);  // 16:9 in front of 4:3
  EXPECT_TRUE(has(error(color, kDepth), "to see all of the smaller"));
  color = camera(160, 120, 280, 79.5, 59.5);  // a narrow view
  EXPECT_TRUE(has(error(color, kDepth), "to see all of the smaller"));
  color = camera(160, 120, 140, 79.5, 59.5);
  color.distortion[0] = 0.1;
  EXPECT_TRUE(has(error(color, kDepth), "the same distortion"));
  RgbdFrame f = frameOf(color, kDepth);
  f.camera.width = 161;
  EXPECT_EQ(errorOf([&] { bringToOneSize(f, kDepth); }),
            "the colour image is 160x120 but its camera is 161x120");
}

}  // namespace
}  // namespace pf

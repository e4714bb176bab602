// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/planes.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "segmenter_scene.hpp"

namespace pf {
namespace {

/// Part of the cells in a box of the image that lie on such a plane; depth with the noise of a
/// structured-light sensor, even in inverse depth.
double partOf(const cv::Mat& depth_m, const cv::Rect& box, Flatness wanted) {
  cv::Mat noisy = depth_m.clone();
  cv::RNG rng(3);
  for (auto z = noisy.begin<float>(); z != noisy.end<float>(); ++z) {
    *z = static_cast<float>(1.0 / (1.0 / *z + rng.gaussian(0.0015)));
  }
  RgbdFrame frame{1, cv::Mat(480, 640, CV_8UC3), noisy, 1e-3, kCamera};
  SceneGrid grid;
  sampleGrid(frame, noisy, 160, grid);
  std::vector<Flatness> flatness;
  PlaneFinder().find(grid, flatness);
  int cells = 0, found = 0;
  for (int cell = 0; cell < grid.size(); ++cell) {
    const cv::Point at(cell % grid.cols * grid.step, cell / grid.cols * grid.step);
    if (!box.contains(at)) continue;
    ++cells;
    found += flatness[cell] == wanted;
  }
  return static_cast<double>(found) / cells;
}

const cv::Rect kMiddle(265, 180, 110, 130);  // pixels: 0.42 m by 0.5 m at 2 m

cv::Mat wall() { return {480, 640, CV_32FC1, cv::Scalar(3.0)}; }

TEST(PlaneFinder, AWallIsLarge) {
  EXPECT_GT(partOf(wall(), {0, 0, 640, 480}, Flatness::large), 0.9);
}

TEST(PlaneFinder, ABoardOfTheSizeOfABackIsSmallHoweverItLeans) {
  for (const float lean_m : {0.0F, 0.1F, -0.2F}) {
    cv::Mat depth = wall();
    for (int v = kMiddle.y; v < kMiddle.br().y; ++v) {
      const float z = 2.0F + lean_m * static_cast<float>(v - kMiddle.y) / kMiddle.height;
      depth.row(v).colRange(kMiddle.x, kMiddle.br().x).setTo(z);
    }
    EXPECT_GT(partOf(depth, kMiddle, Flatness::small), 0.7) << lean_m;
  }
}

TEST(PlaneFinder, ABackIsRoundAndNoPlane) {
  for (const float z : {1.0F, 1.5F, 2.0F, 3.0F}) {
    const int half = cvRound(0.21 * kCamera.fx / z);
    const cv::Rect back(320 - half, 240 - half, 2 * half, 2 * half);
    cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(5.0)), shape = cv::Mat::zeros(480, 640, CV_8UC1);
    shape(back).setTo(255);
    putBody(depth, shape, z, 320);
    EXPECT_EQ(partOf(depth, back, Flatness::small), 0.0) << z;
    EXPECT_LT(partOf(depth, back, Flatness::large), 0.15) << z << ", the wall at its rim";
  }
}

}  // namespace
}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/map/render.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <opencv2/core.hpp>
#include <random>

#include "small_camera.hpp"

namespace pf {
namespace {

struct Disc {
  Eigen::Vector3f position, normal{0, 0, -1};
  float radius = 0.02F, odds = 3, grey = 100;
};

void add(SurfelMap& map, const Disc& d) {
  SurfelArrays s;
  s.resize(1);
  const std::size_t i = 0;
  s.x[i] = d.position.x();
  s.y[i] = d.position.y();
  s.z[i] = d.position.z();
  s.nx[i] = d.normal.x();
  s.ny[i] = d.normal.y();
  s.nz[i] = d.normal.z();
  s.r[i] = s.g[i] = s.b[i] = d.grey;
  s.radius[i] = d.radius;
  s.odds[i] = d.odds;
  map.add(s);
}

/// A wall at z = 2 of overlapping discs, one a pixel, with noise in the depth.
SurfelMap noisyWall(double sigma_m) {
  SurfelMap map{MapConfig{}};
  map.advance();
  std::mt19937 random(4);
  std::normal_distribution<float> noise(0.0F, static_cast<float>(sigma_m) + 1e-12F);
  for (int v = 0; v < smallCamera().height; ++v) {
    for (int u = 0; u < smallCamera().width; ++u) {
      const double z = 2.0 + noise(random);
      add(map, {smallCamera().unproject(u, v, z).cast<float>(), {0, 0, -1}, 1.1F * 2.0F / 130.0F});
    }
  }
  return map;
}

ModelView render(const SurfelMap& map, const RenderOptions& options = {},
                 const Eigen::Isometry3d& T = Eigen::Isometry3d::Identity()) {
  ModelView view;
  SurfelRenderer().render(map, smallCamera(), T, options, view);
  return view;
}

TEST(SurfelRenderer, ShowsAWallWithoutHoles) {
  const ModelView view = render(noisyWall(0));
  EXPECT_EQ(cv::countNonZero(view.depth_m), smallCamera().width * smallCamera().height);
  EXPECT_NEAR(cv::mean(view.depth_m)[0], 2.0, 1e-5);
  EXPECT_NEAR(view.intensity.at<float>(60, 80), 100, 1e-3);
  EXPECT_NEAR(view.normal_z.at<float>(60, 80), -1, 1e-5);
}

TEST(SurfelRenderer, DoesNotPullNoisySurfacesTowardsTheCamera) {
  // The nearest of overlapping discs would be nearer by about one standard deviation.
  const double sigma = 0.01;
  EXPECT_NEAR(cv::mean(render(noisyWall(sigma)).depth_m)[0], 2.0, 0.1 * sigma);
}

TEST(SurfelRenderer, ShowsTheNearestSurface) {
  SurfelMap map = noisyWall(0);
  add(map, {{0, 0, 1.0F}, {0, 0, -1}, 0.05F, 100, 7});
  const ModelView view = render(map);
  EXPECT_NEAR(view.depth_m.at<float>(60, 80), 1.0, 1e-5);
  EXPECT_NEAR(view.intensity.at<float>(60, 80), 7, 1e-3);
  EXPECT_NEAR(view.depth_m.at<float>(20, 20), 2.0, 1e-5);
}

TEST(SurfelRenderer, StableSurfelsHideUnstableOnes) {
  SurfelMap map = noisyWall(0);
  add(map, {{0, 0, 1.0F}, {0, 0, -1}, 0.05F, 1, 7});
  EXPECT_NEAR(render(map).depth_m.at<float>(60, 80), 2.0, 1e-5);
}

TEST(SurfelRenderer, UnstableSurfelsShowWhereNothingElseIs) {
  SurfelMap map{MapConfig{}};
  map.advance();
  add(map, {{0, 0, 1.0F}, {0, 0, -1}, 0.05F, 1, 7});
  EXPECT_NEAR(render(map).depth_m.at<float>(60, 80), 1.0, 1e-5);
  RenderOptions stable;
  stable.only_stable = true;
  EXPECT_EQ(cv::countNonZero(render(map, stable).depth_m), 0);
}

TEST(SurfelRenderer, InactiveSurfelsAreLeftOutWhenAsked) {
  MapConfig config;
  config.active_window_s = 5.0 / 30.0;
  SurfelMap map(config);
  map.advance();
  add(map, {{0, 0, 1.0F}});
  for (int i = 0; i < 6; ++i) map.advance();
  RenderOptions all;
  all.age = SurfelAge::all;
  RenderOptions inactive;
  inactive.age = SurfelAge::inactive;
  EXPECT_EQ(cv::countNonZero(render(map).depth_m), 0);
  EXPECT_GT(cv::countNonZero(render(map, all).depth_m), 0);
  EXPECT_GT(cv::countNonZero(render(map, inactive).depth_m), 0);
}

TEST(SurfelRenderer, DoesNotShowTheBackOfASurfel) {
  SurfelMap map{MapConfig{}};
  map.advance();
  add(map, {{0, 0, 1.0F}, {0, 0, 1}, 0.05F});
  EXPECT_EQ(cv::countNonZero(render(map).depth_m), 0);
}

TEST(SurfelRenderer, IsTheSameFromAMovedCameraInAMovedMap) {
  SurfelMap map{MapConfig{}}, moved{MapConfig{}};
  map.advance();
  moved.advance();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  T.translation() << 1, -2, 0.5;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(-0.5F, 0.5F);
  for (int i = 0; i < 500; ++i) {
    Disc d{{unit(random), unit(random), 1.5F + unit(random)},
           Eigen::Vector3f(unit(random), unit(random), -1).normalized()};
    add(map, d);
    d.position = (T * d.position.cast<double>()).cast<float>();
    d.normal = (T.linear() * d.normal.cast<double>()).cast<float>();
    add(moved, d);
  }
  const cv::Mat a = render(map).depth_m, b = render(moved, {}, T).depth_m;
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  // Rims of discs may fall on the other side of a pixel's centre.
  EXPECT_LT(cv::countNonZero(difference > 1e-3), 0.01 * cv::countNonZero(a));
}

TEST(SurfelRenderer, GivesTheSameBitsForAnyNumberOfThreads) {
  const SurfelMap map = noisyWall(0.02);
  ModelView views[2];
  for (int i = 0; i < 2; ++i) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, i == 0 ? 1 : 4);
    views[i] = render(map);
  }
  EXPECT_EQ(cv::norm(views[0].depth_m, views[1].depth_m, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(views[0].normal_x, views[1].normal_x, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace pf

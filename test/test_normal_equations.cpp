// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/normal_equations.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "posefusion/core/static_odds.hpp"
#include "posefusion/frame/depth_filter.hpp"

namespace pf {
namespace {

/// A wavy wall with a smooth brightness pattern, seen by a small camera.
struct Scene {
  FrameLevel frame;
  ModelPoints model;

  Scene() {
    PinholeCamera& camera = frame.camera;
    camera.width = 96;
    camera.height = 72;
    camera.fx = camera.fy = 90;
    camera.cx = 47.5;
    camera.cy = 35.5;
    const cv::Size size(camera.width, camera.height);
    frame.depth_m.create(size, CV_32FC1);
    frame.intensity.create(size, CV_32FC1);
    for (int v = 0; v < size.height; ++v) {
      for (int u = 0; u < size.width; ++u) {
        frame.depth_m.at<float>(v, u) =
            static_cast<float>(1.2 + 0.1 * std::sin(0.07 * u) + 0.08 * std::cos(0.09 * v));
        frame.intensity.at<float>(v, u) =
            static_cast<float>(120 + 60 * std::sin(0.11 * u + 0.05 * v) + 30 * std::cos(0.1 * v));
      }
    }
    computeNormals(frame.depth_m, camera, DepthSensor{}, frame.normal_x, frame.normal_y,
                   frame.normal_z);
    ModelPlanes planes;
    planes.depth_m = frame.depth_m;
    planes.normal[0] = frame.normal_x;
    planes.normal[1] = frame.normal_y;
    planes.normal[2] = frame.normal_z;
    planes.intensity = frame.intensity;
    planes.odds = cv::Mat(size, CV_32FC1, cv::Scalar(static_odds::kMost));
    model.assign(camera, planes);
  }
};

Eigen::Isometry3d smallMotion(double scale) {
  Vector6d twist;
  twist << 0.004, -0.003, 0.006, 0.003, -0.004, 0.005;
  return expSe3(scale * twist);
}

/// The same sums, plainly and in double precision, from the definitions in the header.
struct Reference {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  int inliers = 0;

  void add(const Eigen::Vector3d& q, const Eigen::Vector3d& a, double weight, double r) {
    Vector6d J;
    J << a, q.cross(a);
    H += weight * J * J.transpose();
    g += weight * J * r;
  }
};

double robustWeight(double x, double scale) {
  const double root = 1.0 / (1.0 + x * x / (scale * scale));
  return root * root;
}

Reference plainSums(const Scene& scene, const Eigen::Isometry3d& T, const TermSettings& s) {
  Reference sums;
  const ModelPoints& m = scene.model;
  const FrameLevel& f = scene.frame;
  for (std::size_t i = 0; i < m.count; ++i) {
    const Eigen::Vector3d q = T * Eigen::Vector3d(m.x[i], m.y[i], m.z[i]);
    const Eigen::Vector3d n = T.linear() * Eigen::Vector3d(m.nx[i], m.ny[i], m.nz[i]);
    const Eigen::Vector2d p = f.camera.project(q);
    if (!(p.x() >= 0 && p.y() >= 0 && p.x() < f.camera.width - 1 && p.y() < f.camera.height - 1)) {
      continue;
    }
    const int u = static_cast<int>(p.x() + 0.5), v = static_cast<int>(p.y() + 0.5);
    const double depth = f.depth_m.at<float>(v, u);
    const Eigen::Vector3d d = q - f.camera.unproject(u, v, depth);
    if (d.norm() >= s.max_distance_m) continue;
    const Eigen::Vector3d fn(f.normal_x.at<float>(v, u), f.normal_y.at<float>(v, u),
                             f.normal_z.at<float>(v, u));
    const double sigma = DepthSensor{}.sigma(static_cast<float>(depth));
    if (n.dot(fn) > s.min_normal_cosine) {
      const double r = n.dot(d);
      if (std::abs(r) < 3.0 * sigma) ++sums.inliers;
      sums.add(q, n, robustWeight(r / sigma, s.robust_scale) / (sigma * sigma), r);
    }
    if (s.photometric_sigma <= 0) continue;
    const int cu = static_cast<int>(p.x()), cv_ = static_cast<int>(p.y());
    const double a = p.x() - cu, b = p.y() - cv_;
    const auto at = [&](int dv, int du) { return f.intensity.at<float>(cv_ + dv, cu + du); };
    const double top = at(0, 0) + a * (at(0, 1) - at(0, 0));
    const double bottom = at(1, 0) + a * (at(1, 1) - at(1, 0));
    const double r =
        top + b * (bottom - top) - (s.brightness.gain * m.intensity[i] + s.brightness.offset);
    const double gu = (1 - b) * (at(0, 1) - at(0, 0)) + b * (at(1, 1) - at(1, 0));
    const double gx = gu * f.camera.fx / q.z(), gy = (bottom - top) * f.camera.fy / q.z();
    sums.add(
        q, {gx, gy, -(gx * q.x() + gy * q.y()) / q.z()},
        robustWeight(r / s.photometric_sigma, 3.0) / (s.photometric_sigma * s.photometric_sigma),
        r);
  }
  return sums;
}

TEST(NormalEquations, AgreeWithPlainSums) {
  const Scene scene;
  for (const float photometric_sigma : {0.0F, 10.0F}) {
    TermSettings settings;
    settings.photometric_sigma = photometric_sigma;
    settings.brightness = {1.1F, 2.0F};
    const Eigen::Isometry3d T = smallMotion(1.0);
    const NormalEquations sums = buildNormalEquations(scene.model, scene.frame, T, settings);
    const Reference plain = plainSums(scene, T, settings);
    // Points that project to the middle between two pixels may round either way in float.
    EXPECT_NEAR(sums.inliers, plain.inliers, 0.005 * plain.inliers);
    EXPECT_LT((sums.hessian() - plain.H).norm(), 0.01 * plain.H.norm());
    EXPECT_LT((sums.gradient() - plain.g).norm(), 0.02 * plain.g.norm());
  }
}

TEST(NormalEquations, PhotometricGradientIsTheDerivativeOfTheError) {
  // With the colour term alone and a wide robust scale the error is smooth in the pose.
  const Scene scene;
  TermSettings settings;
  settings.photometric_sigma = 1000.0F;
  settings.min_normal_cosine = 2.0F;  // no geometric inliers
  const Eigen::Isometry3d T = smallMotion(0.7);
  const auto errorAt = [&](const Eigen::Isometry3d& pose) {
    return buildNormalEquations(scene.model, scene.frame, pose, settings).photometric_error;
  };
  const Vector6d g =
      2.0 * 1e6 * buildNormalEquations(scene.model, scene.frame, T, settings).gradient();
  const double total = errorAt(T);
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = 2e-4 * Vector6d::Unit(i);
    const double numeric = (errorAt(expSe3(step) * T) - errorAt(expSe3(-step) * T)) / 4e-4;
    // Points that leave the image make small jumps in the error.
    EXPECT_NEAR(g[i], numeric, 0.05 * g.norm() + 1e-3 * total) << "component " << i;
  }
}

TEST(NormalEquations, StepsLeadBackToTheTrueMotion) {
  const Scene scene;
  TermSettings settings;
  settings.photometric_sigma = 10.0F;
  Eigen::Isometry3d T = smallMotion(1.0);
  for (int i = 0; i < 15; ++i) {
    const NormalEquations e = buildNormalEquations(scene.model, scene.frame, T, settings);
    T = expSe3(e.hessian().ldlt().solve(-e.gradient())) * T;
  }
  EXPECT_LT(logSe3(T).norm(), 2e-4);
}

TEST(NormalEquations, GiveTheSameBitsForAnyNumberOfThreads) {
  const Scene scene;
  const TermSettings settings;
  NormalEquations sums[2];
  for (int i = 0; i < 2; ++i) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, i == 0 ? 1 : 4);
    sums[i] = buildNormalEquations(scene.model, scene.frame, smallMotion(1), settings);
  }
  for (int k = 0; k < 21; ++k) EXPECT_EQ(sums[0].H[k], sums[1].H[k]);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(sums[0].g[k], sums[1].g[k]);
}

TEST(NormalEquations, OfNothingAreZero) {
  const Scene scene;
  ModelPoints nothing;
  ModelPlanes planes;
  for (cv::Mat* plane : {&planes.depth_m, &planes.normal[0], &planes.normal[1], &planes.normal[2],
                         &planes.intensity, &planes.odds}) {
    *plane = cv::Mat::zeros(72, 96, CV_32FC1);
  }
  nothing.assign(scene.frame.camera, planes);
  EXPECT_EQ(nothing.count, 0U);
  const NormalEquations sums = buildNormalEquations(nothing, scene.frame, smallMotion(1), {});
  EXPECT_EQ(sums.candidates, 0);
  EXPECT_EQ(sums.hessian().norm(), 0);
}

TEST(NormalEquations, WhatTheSensorMayBeOffByIsNoOtherSurface) {
  Scene scene;
  TermSettings settings;
  settings.photometric_sigma = 0.0F;
  Eigen::Isometry3d nearer = Eigen::Isometry3d::Identity();
  nearer.translation().z() = -1.2 * settings.max_distance_m;  // the model comes before the frame
  const auto summed = [&] {
    return buildNormalEquations(scene.model, scene.frame, nearer, settings);
  };
  EXPECT_EQ(summed().inliers, 0);
  EXPECT_GT(summed().seen_through, 0.9 * summed().candidates);
  settings.sensor.axial_m = settings.max_distance_m;  // as noisy as that
  EXPECT_GT(summed().inliers, 0.9 * summed().candidates);
  EXPECT_EQ(summed().seen_through, 0);
}

TEST(NormalEquations, DoNotListenToHolesInTheFrame) {
  Scene scene;
  scene.frame.depth_m.setTo(0);
  const NormalEquations sums =
      buildNormalEquations(scene.model, scene.frame, Eigen::Isometry3d::Identity(), {});
  EXPECT_EQ(sums.candidates, 0);
  EXPECT_EQ(sums.hessian().norm(), 0);
}

}  // namespace
}  // namespace pf

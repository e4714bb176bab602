// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "posefusion/evaluation/mesh_check.hpp"
#include "posefusion/evaluation/seen_surface.hpp"

namespace pf {
namespace {

using Eigen::Vector3f;

/// The square 0 <= x, y <= 1 at z = 0, facing up, sampled every 2 cm.
SurfaceSamples squareTruth() {
  SurfaceSamples truth;
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k < 50; ++k) {
      truth.positions.emplace_back(0.02F * static_cast<float>(i) + 0.01F,
                                   0.02F * static_cast<float>(k) + 0.01F, 0.0F);
      truth.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
  }
  return truth;
}

/// A rectangle 0 <= x <= `width`, 0 <= y <= 1 at height z, of two triangles.
TriangleMesh rectangle(float width, float z) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, z}, {width, 0, z}, {width, 1, z}, {0, 1, z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

SurfelArrays oneSurfel(const Vector3f& at) {
  SurfelArrays s;
  s.resize(1);
  s.x[0] = at.x(), s.y[0] = at.y(), s.z[0] = at.z();
  s.nz[0] = 1;
  s.radius[0] = 0.02F;
  return s;
}

MeshScore check(const TriangleMesh& mesh, const SurfelArrays& surfels) {
  return checkMesh(mesh, surfels, Eigen::Isometry3d::Identity(), squareTruth(), squareTruth());
}

TEST(MeshCheck, SamplesHaveTheAreaOfTheMesh) {
  const MeshSamples samples = sampleMesh(rectangle(0.37F, 2));
  double area = 0;
  for (const float a : samples.area_m2) area += a;
  EXPECT_NEAR(area, 0.37, 1e-4);
  for (const Vector3f& p : samples.positions) {
    EXPECT_TRUE(p.x() > 0 && p.x() < 0.37F && p.y() > 0 && p.y() < 1 && p.z() == 2);
  }
}

TEST(MeshCheck, MeasuresDistanceAndArea) {
  const MeshScore score = check(rectangle(0.5F, 0.015F), oneSurfel({0.1F, 0.1F, 0}));
  EXPECT_NEAR(score.median_m, 0.015, 1e-4);
  EXPECT_NEAR(score.p95_m, 0.015, 1e-4);
  EXPECT_NEAR(score.area_m2, 0.5, 1e-3);
  EXPECT_NEAR(score.coverage(), 0.5, 0.025);  // and what lies right beside the rim
}

TEST(MeshCheck, ABackCoversNothing) {
  TriangleMesh mesh = rectangle(1, 0.05F);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(check(mesh, oneSurfel({0, 0, 0})).covered, 0U);
  EXPECT_EQ(check({}, oneSurfel({0, 0, 0})).coverage(), 0.0);
}

TEST(MeshCheck, ATriangleWithoutASurfelIsInvented) {
  EXPECT_EQ(check(rectangle(1, 0), oneSurfel({1, 0, 0.04F})).invented, 1U);
  EXPECT_EQ(check(rectangle(1, 0), oneSurfel({1, 0, 0.06F})).invented, 2U);
  EXPECT_EQ(check(rectangle(1, 0), oneSurfel({0, 0, 0.04F})).invented, 0U);
}

TEST(SeenSurface, WantsThreeViewsFromBeforeWithinRange) {
  const SurfaceSamples truth = squareTruth();
  SeenSurface seen(truth, DepthSensor());
  RgbdFrame frame;
  frame.camera.width = 64, frame.camera.height = 48;
  frame.camera.fx = frame.camera.fy = 50, frame.camera.cx = 31.5, frame.camera.cy = 23.5;
  frame.depth = cv::Mat(48, 64, CV_32FC1, cv::Scalar(2.0));
  Eigen::Isometry3d above = Eigen::Isometry3d::Identity();  // 2 m above the middle, looks down
  above.translation() = Eigen::Vector3d(0.5, 0.5, 2);
  above.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  cv::Mat mask(48, 64, CV_8UC1, cv::Scalar(0));
  for (int view = 0; view < 2; ++view) seen.add(frame, {}, above);
  EXPECT_TRUE(seen.seenWell().positions.empty());
  mask.colRange(0, 32) = 255;  // a person before the left half
  seen.add(frame, mask, above);
  EXPECT_EQ(seen.views(), 3U);
  for (const Vector3f& p : seen.seenWell().positions) EXPECT_GT(p.x(), 0.48F);
  EXPECT_NEAR(static_cast<double>(seen.seenWell().positions.size()), 1250, 60);
  SeenSurface other(truth, DepthSensor());
  frame.depth = cv::Scalar(1.5);  // something else is seen
  for (int view = 0; view < 3; ++view) other.add(frame, {}, above);
  EXPECT_TRUE(other.seenWell().positions.empty());
}

}  // namespace
}  // namespace pf

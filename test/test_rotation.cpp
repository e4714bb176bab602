// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/tracking/rotation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

PinholeCamera camera80() {
  PinholeCamera camera;
  camera.width = 80;
  camera.height = 60;
  camera.fx = camera.fy = 66;
  camera.cx = 39.5;
  camera.cy = 29.5;
  return camera;
}

/// A textured sphere around the camera, seen with its rotation R_world_camera.
SmallImage view(const Eigen::Matrix3d& R, float brightness = 0) {
  const PinholeCamera camera = camera80();
  SmallImage image;
  image.intensity.create(camera.height, camera.width, CV_32FC1);
  image.still = cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(255));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d d = (R * camera.unproject(u, v, 1)).normalized();
      image.intensity.at<float>(v, u) =
          static_cast<float>(120 + brightness + 40 * std::sin(9 * d.x() + 2 * d.y()) +
                             40 * std::sin(11 * d.y() - d.x()));
    }
  }
  return image;
}

TEST(AlignRotation, FindsATurnOfTheCamera) {
  const Eigen::Matrix3d R = expSo3({0.03, -0.05, 0.04});
  const Eigen::Matrix3d found =
      alignRotation(view(Eigen::Matrix3d::Identity()), view(R), camera80());
  // Points of the previous image are seen at R^T from the turned camera.
  EXPECT_LT(logSo3(found * R).norm(), 2e-3);
}

TEST(AlignRotation, DoesNotMindAnotherExposure) {
  const Eigen::Matrix3d R = expSo3({0.0, 0.04, 0.0});
  const Eigen::Matrix3d found =
      alignRotation(view(Eigen::Matrix3d::Identity()), view(R, 25), camera80());
  EXPECT_LT(logSo3(found * R).norm(), 2e-3);
}

TEST(AlignRotation, IsIdentityWithoutTexture) {
  SmallImage flat = view(Eigen::Matrix3d::Identity());
  flat.intensity.setTo(100);
  EXPECT_TRUE(alignRotation(flat, flat, camera80()).isIdentity());
}

TEST(AlignRotation, IsIdentityWhenPeopleFillTheView) {
  SmallImage covered = view(expSo3({0.05, 0, 0}));
  covered.still.setTo(0);
  EXPECT_TRUE(alignRotation(view(Eigen::Matrix3d::Identity()), covered, camera80()).isIdentity());
}

}  // namespace
}  // namespace pf

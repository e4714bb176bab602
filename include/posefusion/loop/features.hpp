// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/depth_sensor.hpp"

namespace pf {

/// A picture with depth to find features in.
struct FeatureImage {
  cv::Mat intensity;  ///< CV_8UC1
  cv::Mat depth_m;    ///< CV_32FC1, same size, 0 = nothing known (or a person's)
  PinholeCamera camera;
};

/// Points that can be recognised again, with their places.
struct Features {
  static constexpr int kDescriptor = 128;

  std::vector<Eigen::Vector3f> points;  ///< m, camera frame
  cv::Mat descriptors;                  ///< CV_8UC1, one row of kDescriptor each

  std::size_t size() const { return points.size(); }
};

/// SIFT (Lowe 2004) where there is depth: the strongest `most`.
Features findFeatures(const FeatureImage& image, int most = 600);

/// Two pictures of one place.
struct FeatureMatch {
  bool found = false;
  /// From the camera frame of the second picture to that of the first.
  Eigen::Isometry3d T_first_second = Eigen::Isometry3d::Identity();
  int matches = 0;
  int inliers = 0;
};

/// Descriptors that are each other's nearest, and much nearer than the second; of those the rigid
/// motion that most agree with (RANSAC over three pairs, Fischler and Bolles 1981, fixed seed; Horn
/// 1987 over the inliers). Found with a dozen inliers; may still be wrong where things repeat.
FeatureMatch matchFeatures(const Features& first, const Features& second,
                           const DepthSensor& sensor);

std::string toBytes(const Features& features);
/// Throws InputError saying what is wrong with the bytes.
Features featuresFromBytes(const std::string& bytes);

}  // namespace pf

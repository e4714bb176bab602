// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/depth_sensor.hpp"

namespace pf {

/// Depth images here are CV_32FC1 in metres, 0 = invalid. Every function writes into its last
/// arguments, reusing their memory, and gives the same bits for any number of threads. Means are
/// taken of the inverse depth: planes are linear in it, so that leaning surfaces are not moved, and
/// the noise of structured light and stereo is even in it. The noise of the sensor decides what
/// lies on one surface.

/// Each block of factor x factor pixels becomes the mean of those of its valid pixels that lie on
/// the nearest surface in it: silhouettes are kept, noise falls.
void shrinkDepth(const cv::Mat& depth_m, int factor, const DepthSensor& sensor, cv::Mat& small_m);

/// Edge-preserving smoothing over 7x7 pixels. The range kernel is Tukey's biweight with a width
/// that follows the sensor's noise, so that a step of the scene survives at any distance.
void smoothDepth(const cv::Mat& depth_m, const DepthSensor& sensor, cv::Mat& smooth_m);

/// Unit normals towards the camera by central differences; all three 0 where a neighbour is missing
/// or lies on another surface.
void computeNormals(const cv::Mat& depth_m, const PinholeCamera& camera, const DepthSensor& sensor,
                    cv::Mat& normal_x, cv::Mat& normal_y, cv::Mat& normal_z);

/// From where on (m) the normals of a smoothed image of this camera are off by more than 0.26 rad
/// (15 degrees) by noise alone: its neighbouring pixels are too close to each other for their
/// difference to show how the surface leans.
float noisyNormalsFrom(const PinholeCamera& camera, const DepthSensor& sensor);

/// Depth from `from_m` on takes its normals from a coarser image (`factor` pixels become one) where
/// that has any.
void takeCoarseNormals(const cv::Mat& depth_m, float from_m, const std::array<cv::Mat, 3>& coarse,
                       int factor, const std::array<cv::Mat*, 3>& normals);

/// Grey levels 0..255 (CV_32FC1) of an R G B image, each pixel the mean of a factor x factor block.
void shrinkToIntensity(const cv::Mat& color, int factor, cv::Mat& intensity);

/// Mean of 2x2 blocks of a CV_32FC1 image.
void halveIntensity(const cv::Mat& intensity, cv::Mat& small);

}  // namespace pf

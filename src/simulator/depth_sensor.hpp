// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/core/camera.hpp"
#include "simulator/renderer.hpp"
#include "simulator/sensor_config.hpp"

namespace pf::simulator {

/// Standard deviation along the view (m) at depth `z_m` and angle `theta_rad` between view and
/// surface normal: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved 3D
/// Reconstruction and Tracking", 2012, equations 3 and 4.
double axialSigmaM(double z_m, double theta_rad);

/// Standard deviation across the view (pixels), ibid. equation 2.
double lateralSigmaPx(double theta_rad);

/// Width of one step of depth (m): disparity in steps of 1 / steps pixels (Khoshelham and Elberink,
/// "Accuracy and Resolution of Kinect Depth Data", 2012, section 2.4).
double quantumM(double z_m, const DepthConfig& config, double focal_px);

/// From what is there to what the depth camera reports: CV_16UC1, millimetres, 0 = no depth.
/// Truth that changes with the noise is changed along (lateral noise moves mask and depth
/// together): `mask` receives, for every pixel, the person (1 + index) its depth came from, 0 for
/// the world.
void senseDepth(const DepthView& view, const PinholeCamera& camera, const DepthConfig& config,
                std::uint32_t key, cv::Mat& depth_mm, cv::Mat& mask);

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "shape.hpp"
#include "texture.hpp"

namespace pf::synthetic {

/// What a perfect camera sees.
struct Picture {
  cv::Mat color;  ///< CV_8UC3, R G B
  cv::Mat depth;  ///< CV_32FC1, metres along the optical axis
  cv::Mat mask;   ///< CV_8UC1, 255 = a person
};

/// Casts one ray through each pixel's centre. The light is fixed in the room and casts no shadow.
Picture render(const std::vector<Shape>& shapes, const std::vector<Texture>& textures,
               const PinholeCamera& camera, const Eigen::Isometry3d& T_room_camera);

}  // namespace pf::synthetic

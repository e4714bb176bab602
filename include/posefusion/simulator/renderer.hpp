// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/simulator/avatar.hpp"
#include "posefusion/simulator/lighting.hpp"
#include "posefusion/simulator/raycaster.hpp"

namespace posefusion::simulator {

/// Where the camera is when it takes one sample of a picture.
struct ViewSample {
  Eigen::Matrix3f R_world_camera = Eigen::Matrix3f::Identity();
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();
  float time = 0.5F;  ///< between the two shapes of the people, 0..1
};

/// The four pixels of a 2x2 neighbourhood take a sample at different moments.
constexpr int kViewsPerSample = 4;

/// What a picture is taken with: views for each band of rows (one band: a global shutter).
struct Shutter {
  int samples = 1;  ///< rays a pixel
  int bands = 1;
  std::vector<ViewSample> views;  ///< [band][sample][kViewsPerSample]

  const ViewSample* at(int row, int height, int sample) const {
    const int band = row * bands / height;
    return &views[static_cast<std::size_t>((band * samples + sample) * kViewsPerSample)];
  }
};

/// What the depth camera's pixels see, without its errors.
struct DepthView {
  cv::Mat depth_m;   ///< CV_32FC1, along the optical axis; 0: nothing
  cv::Mat person;    ///< CV_8UC1: 0 the world, 1 + index a person
  cv::Mat cosine;    ///< CV_32FC1, of the angle between view and surface
  cv::Mat infrared;  ///< CV_32FC1, reflectance
  cv::Mat gloss;     ///< CV_32FC1
};

/// Draws the world and the people with rays. Every pixel is its own: the result does not depend on
/// the number of threads.
class Renderer {
 public:
  Renderer(const World& world, const RayCaster& caster, const Lighting& lighting,
           const std::vector<Avatar>& people);

  /// Light on the people's vertices for the shapes in the caster; only those who may be seen.
  void lightPeople(const std::vector<std::vector<Eigen::Vector3f>>& positions,
                   const std::vector<std::vector<Eigen::Vector3f>>& normals,
                   const Eigen::Vector3f& seen_from);

  /// Mean radiance through the shutter, CV_32FC3 R G B.
  void color(const PinholeCamera& camera, const Shutter& shutter, cv::Mat& radiance) const;

  void depth(const PinholeCamera& camera, const ViewSample& view, DepthView& out) const;

 private:
  Eigen::Vector3f shade(const RayPacket& packet, int lane, float pixel_rad) const;
  Eigen::Vector3f shadeWorld(const RayPacket& packet, int lane, float pixel_rad) const;
  Eigen::Vector3f shadePerson(const RayPacket& packet, int lane) const;
  void storeDepth(const RayPacket& packet, int lane, const Eigen::Vector2i& pixel,
                  const Eigen::Vector3f& axis, DepthView& out) const;

  const World& world_;
  const RayCaster& caster_;
  const Lighting& lighting_;
  const std::vector<Avatar>& people_;
  std::vector<std::vector<Eigen::Vector3f>> people_light_;
};

}  // namespace posefusion::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "simulator/avatar.hpp"
#include "simulator/lighting.hpp"
#include "simulator/raycaster.hpp"

namespace pf::simulator {

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
  cv::Mat label;     ///< CV_8UC1: 0 the world, 1 + index a person, kFirstThing + index a thing
  cv::Mat cosine;    ///< CV_32FC1, of the angle between view and surface
  cv::Mat infrared;  ///< CV_32FC1, reflectance
  cv::Mat gloss;     ///< CV_32FC1
  cv::Mat contrast;  ///< CV_32FC1, of the texture (Texture::contrast()); empty: none
};

/// What is drawn: the people and things of a frame and the light of it.
struct Scene {
  const PosedMovers& movers;
  const FrameLight& light;
};

/// Draws the world and what moves in it with rays. Every pixel is its own: the result does not
/// depend on the number of threads. Thread safe.
class Renderer {
 public:
  Renderer(const World& world, const RayCaster& caster) : world_(world), caster_(caster) {}

  /// Mean radiance, CV_32FC3 R G B: through the shutter `still`, and again through `moving` where
  /// that has more samples and the first showed a person or a thing in the 4x4 pixels.
  void color(const PinholeCamera& camera, const Shutter& still, const Shutter& moving,
             const Scene& scene, cv::Mat& radiance) const;

  void depth(const PinholeCamera& camera, const ViewSample& view, const PosedMovers& movers,
             DepthView& out) const;

 private:
  /// True when it shows a person or a thing.
  bool drawBlock(const PinholeCamera& camera, const Shutter& shutter, const Scene& scene,
                 const Eigen::Vector2i& corner, cv::Mat& radiance) const;
  Eigen::Vector3f shade(const RayPacket& packet, int lane, float pixel_rad,
                        const Scene& scene) const;
  Eigen::Vector3f shadeMesh(const RayPacket& packet, int lane, float pixel_rad, const Mesh& mesh,
                            const std::vector<Eigen::Vector3f>& light) const;
  void storeDepth(const RayPacket& packet, int lane, const PosedMovers& movers,
                  const Eigen::Vector2i& pixel, const Eigen::Vector3f& axis, DepthView& out) const;

  const World& world_;
  const RayCaster& caster_;
};

}  // namespace pf::simulator

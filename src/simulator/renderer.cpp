// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "posefusion/core/parallel.hpp"

namespace pf::simulator {
namespace {

/// Of the texture of cloth, hair and skin.
constexpr float kClothContrast = 0.1F;

using Eigen::Vector3f;

constexpr int kTile = 32;  // pixels, a multiple of the 4x4 of a packet

/// Place of sample `s` within its pixel, (-0.5, 0.5): the R2 sequence (Roberts 2018).
Eigen::Vector2f sampleOffset(int s, int samples) {
  if (samples == 1) return Eigen::Vector2f::Zero();
  const float u = 0.5F + static_cast<float>(s) * 0.7548777F;
  const float v = 0.5F + static_cast<float>(s) * 0.5698403F;
  return {u - std::floor(u) - 0.5F, v - std::floor(v) - 0.5F};
}

/// Rays through a block of 4x4 pixels. Pixels of a 2x2 neighbourhood take their views in turn.
void aim(const PinholeCamera& camera, const ViewSample* views, const Eigen::Vector2i& corner,
         const Eigen::Vector2f& offset, RayPacket& packet) {
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  for (int lane = 0; lane < 16; ++lane) {
    const int col = corner.x() + lane % 4, row = corner.y() + lane / 4;
    const ViewSample& view = views[lane % 2 + 2 * (lane / 4 % 2)];
    packet.valid[lane] = col < camera.width && row < camera.height ? -1 : 0;
    const Vector3f d =
        view.R_world_camera * Vector3f((static_cast<float>(col) + offset.x() - cx) / fx,
                                       (static_cast<float>(row) + offset.y() - cy) / fy, 1.0F);
    RTCRay16& ray = packet.rays.ray;
    ray.org_x[lane] = view.origin.x();
    ray.org_y[lane] = view.origin.y();
    ray.org_z[lane] = view.origin.z();
    ray.dir_x[lane] = d.x();  // length 1 along the axis: tfar is the depth
    ray.dir_y[lane] = d.y();
    ray.dir_z[lane] = d.z();
    ray.tnear[lane] = 0.02F;
    ray.tfar[lane] = std::numeric_limits<float>::infinity();
    ray.time[lane] = view.time;
  }
}

/// Calls body(corner of a 4x4 block) for all blocks, tiles in parallel.
template <typename Body>
void forBlocks(const PinholeCamera& camera, const Body& body) {
  const int columns = (camera.width + kTile - 1) / kTile,
            rows = (camera.height + kTile - 1) / kTile;
  parallelFor(static_cast<std::size_t>(columns * rows), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) {
      const int x0 = static_cast<int>(tile) % columns * kTile;
      const int y0 = static_cast<int>(tile) / columns * kTile;
      for (int y = y0; y < std::min(y0 + kTile, camera.height); y += 4) {
        for (int x = x0; x < std::min(x0 + kTile, camera.width); x += 4) {
          body(Eigen::Vector2i(x, y));
        }
      }
    }
  });
}

Vector3f shadePerson(const RayPacket& packet, int lane, const Scene& scene) {
  const std::size_t person = packet.rays.hit.geomID[lane] - 1U;
  const std::uint32_t triangle = packet.rays.hit.primID[lane];
  const float u = packet.rays.hit.u[lane], v = packet.rays.hit.v[lane];
  const Avatar& avatar = scene.movers.avatar(person);
  const auto& t = avatar.triangles()[triangle];
  const auto& light = scene.light.people[person];
  const Vector3f incoming = (1.0F - u - v) * light[t[0]] + u * light[t[1]] + v * light[t[2]];
  return avatar.appearance().color(avatar.surfacePoint(triangle, u, v)).cwiseProduct(incoming);
}

}  // namespace

Vector3f Renderer::shadeMesh(const RayPacket& packet, int lane, float pixel_rad, const Mesh& mesh,
                             const std::vector<Vector3f>& light) const {
  const std::uint32_t triangle = packet.rays.hit.primID[lane];
  const auto& t = mesh.triangles[triangle];
  const float u = packet.rays.hit.u[lane], v = packet.rays.hit.v[lane], w = 1.0F - u - v;
  const Vector3f incoming = w * light[t[0]] + u * light[t[1]] + v * light[t[2]];
  const Eigen::Vector2f uv = w * mesh.uv[t[0]] + u * mesh.uv[t[1]] + v * mesh.uv[t[2]];
  const Material& material = world_.materials[mesh.materials[triangle]];
  const float size = material.picture_size_m > 0.0F ? material.picture_size_m : 0.6F;
  const float footprint = packet.rays.ray.tfar[lane] * pixel_rad / size;
  const Vector3f albedo = world_.textures[static_cast<std::size_t>(material.texture)]
                              .sample(uv.x(), uv.y(), footprint)
                              .cwiseProduct(material.tint);
  if (material.emission.isZero()) return albedo.cwiseProduct(incoming);
  return albedo.cwiseProduct(incoming + material.emission);
}

Vector3f Renderer::shade(const RayPacket& packet, int lane, float pixel_rad,
                         const Scene& scene) const {
  const std::uint32_t geometry = packet.rays.hit.geomID[lane];
  if (geometry == RTC_INVALID_GEOMETRY_ID) return Vector3f::Constant(0.02F);
  if (geometry == 0) return shadeMesh(packet, lane, pixel_rad, world_.mesh, scene.light.world);
  if (geometry < kFirstThing) return shadePerson(packet, lane, scene);
  const std::size_t thing = geometry - kFirstThing;
  return shadeMesh(packet, lane, pixel_rad, scene.movers.thing(thing), scene.light.things[thing]);
}

bool Renderer::drawBlock(const PinholeCamera& camera, const Shutter& shutter, const Scene& scene,
                         const Eigen::Vector2i& corner, cv::Mat& radiance) const {
  const auto pixel_rad = static_cast<float>(1.0 / camera.fx);
  std::array<Vector3f, 16> sum;
  sum.fill(Vector3f::Zero());
  bool movers = false;
  RayPacket packet;
  for (int s = 0; s < shutter.samples; ++s) {
    aim(camera, shutter.at(corner.y(), camera.height, s), corner, sampleOffset(s, shutter.samples),
        packet);
    caster_.trace(packet);
    scene.movers.trace(packet);
    for (int lane = 0; lane < 16; ++lane) {
      if (packet.valid[lane] == 0) continue;
      sum[static_cast<std::size_t>(lane)] += shade(packet, lane, pixel_rad, scene);
      const std::uint32_t geometry = packet.rays.hit.geomID[lane];
      movers |= geometry != 0 && geometry != RTC_INVALID_GEOMETRY_ID;
    }
  }
  for (int lane = 0; lane < 16; ++lane) {
    if (packet.valid[lane] == 0) continue;
    const Vector3f mean = sum[static_cast<std::size_t>(lane)] / static_cast<float>(shutter.samples);
    radiance.at<cv::Vec3f>(corner.y() + lane / 4, corner.x() + lane % 4) = {mean.x(), mean.y(),
                                                                            mean.z()};
  }
  return movers;
}

void Renderer::color(const PinholeCamera& camera, const Shutter& still, const Shutter& moving,
                     const Scene& scene, cv::Mat& radiance) const {
  radiance.create(camera.height, camera.width, CV_32FC3);
  forBlocks(camera, [&](const Eigen::Vector2i& corner) {
    const bool movers = drawBlock(camera, still, scene, corner, radiance);
    if (movers && moving.samples > still.samples) {
      drawBlock(camera, moving, scene, corner, radiance);
    }
  });
}

void Renderer::storeDepth(const RayPacket& packet, int lane, const PosedMovers& movers,
                          const Eigen::Vector2i& pixel, const Vector3f& axis,
                          DepthView& out) const {
  const int row = pixel.y(), col = pixel.x();
  const auto& hit = packet.rays.hit;
  const auto& ray = packet.rays.ray;
  const std::uint32_t geometry = hit.geomID[lane];
  const bool any = geometry != RTC_INVALID_GEOMETRY_ID;
  const Vector3f d(ray.dir_x[lane], ray.dir_y[lane], ray.dir_z[lane]);
  out.depth_m.at<float>(row, col) = any ? ray.tfar[lane] * d.dot(axis) : 0.0F;
  out.label.at<std::uint8_t>(row, col) = any ? static_cast<std::uint8_t>(geometry) : 0;
  out.cosine.at<float>(row, col) = 0.0F;
  out.infrared.at<float>(row, col) = 0.0F;
  out.gloss.at<float>(row, col) = 0.0F;
  out.contrast.at<float>(row, col) = 0.0F;
  if (!any) return;
  const Vector3f n(hit.Ng_x[lane], hit.Ng_y[lane], hit.Ng_z[lane]);
  out.cosine.at<float>(row, col) = std::abs(n.dot(d)) / std::max(n.norm() * d.norm(), 1e-12F);
  if (geometry == 0 || geometry >= kFirstThing) {
    const Mesh& mesh = geometry == 0 ? world_.mesh : movers.thing(geometry - kFirstThing);
    const Material& material = world_.materials[mesh.materials[hit.primID[lane]]];
    out.infrared.at<float>(row, col) = material.infrared;
    out.gloss.at<float>(row, col) = material.gloss;
    out.contrast.at<float>(row, col) = material.contrast;
    return;
  }
  out.contrast.at<float>(row, col) = kClothContrast;
  const Avatar& avatar = movers.avatar(geometry - 1U);
  out.infrared.at<float>(row, col) =
      avatar.appearance().infrared(avatar.surfacePoint(hit.primID[lane], hit.u[lane], hit.v[lane]));
}

void Renderer::depth(const PinholeCamera& camera, const ViewSample& view, const PosedMovers& movers,
                     DepthView& out) const {
  const cv::Size size(camera.width, camera.height);
  for (cv::Mat* image : {&out.depth_m, &out.cosine, &out.infrared, &out.gloss, &out.contrast}) {
    image->create(size, CV_32FC1);
  }
  out.label.create(size, CV_8UC1);
  const Vector3f axis = view.R_world_camera.col(2);
  const ViewSample views[kViewsPerSample] = {view, view, view, view};
  forBlocks(camera, [&](const Eigen::Vector2i& corner) {
    RayPacket packet;
    aim(camera, views, corner, Eigen::Vector2f::Zero(), packet);
    caster_.trace(packet);
    movers.trace(packet);
    for (int lane = 0; lane < 16; ++lane) {
      if (packet.valid[lane] == 0) continue;
      storeDepth(packet, lane, movers, corner + Eigen::Vector2i(lane % 4, lane / 4), axis, out);
    }
  });
}

}  // namespace pf::simulator

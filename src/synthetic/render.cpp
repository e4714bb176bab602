// SPDX-License-Identifier: BSD-3-Clause
#include "render.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/parallel.hpp"

namespace pf::synthetic {
namespace {

using Vec3 = Eigen::Vector3f;
using PlacedShapes = std::vector<const PlacedShape*>;

constexpr int kTile = 16;  // pixels; shapes are sorted out per tile

/// Lambert's law under two ceiling lamps and ambient light, room frame.
float brightness(const Vec3& point, const Vec3& normal) {
  static const std::array<Vec3, 2> kLamps = {Vec3(1.5F, 2.0F, 2.45F), Vec3(4.0F, 2.8F, 2.45F)};
  float sum = 0.55F;
  for (const Vec3& lamp : kLamps) {
    const Vec3 to_lamp = lamp - point;
    const float distance2 = to_lamp.squaredNorm();
    const float cosine = normal.dot(to_lamp) / std::sqrt(distance2);
    sum += 0.45F * std::max(0.0F, cosine) * 3.0F / (1.5F + distance2);
  }
  return sum;
}

class Renderer {
 public:
  Renderer(const std::vector<Texture>& textures, const PinholeCamera& camera, Picture& picture)
      : textures_(textures), camera_(camera), picture_(picture) {}

  void renderTile(const cv::Rect& tile, const PlacedShapes& shapes) {
    for (int row = tile.y; row < tile.br().y; ++row) {
      const float y = static_cast<float>((row - camera_.cy) / camera_.fy);
      for (int col = tile.x; col < tile.br().x; ++col) {
        const Vec3 ray(static_cast<float>((col - camera_.cx) / camera_.fx), y, 1.0F);
        Hit hit;
        const PlacedShape* nearest = nullptr;
        for (const PlacedShape* shape : shapes)
          if (shape->pixels().contains({col, row}) && shape->intersect(ray, hit)) nearest = shape;
        if (nearest == nullptr) continue;
        picture_.depth.at<float>(row, col) = hit.z_m;
        picture_.mask.at<std::uint8_t>(row, col) = nearest->shape().is_person ? 255 : 0;
        picture_.color.at<cv::Vec3b>(row, col) = shade(*nearest, hit, ray);
      }
    }
  }

 private:
  cv::Vec3b shade(const PlacedShape& placed, const Hit& hit, const Vec3& ray) const {
    const Shape& shape = placed.shape();
    const Material& material = shape.materials[static_cast<std::size_t>(hit.face)];
    const Eigen::Vector2f uv =
        placed.surfaceCoordinates(hit).cwiseProduct(material.repeats_per_m) + material.offset;
    const float cosine = placed.incidence(hit, ray);
    const float pixel_m =
        hit.z_m / static_cast<float>(camera_.fx) / std::sqrt(std::max(cosine, 0.05F));
    const Texture& texture = textures_[static_cast<std::size_t>(material.surface)];
    const cv::Vec3f color =
        texture.sample(uv.x(), uv.y(), pixel_m * material.repeats_per_m.maxCoeff()) *
        brightness(shape.T_room_shape * hit.point, shape.T_room_shape.linear() * hit.normal);
    return color;  // rounds and saturates
  }

  const std::vector<Texture>& textures_;
  const PinholeCamera& camera_;
  Picture& picture_;
};

}  // namespace

Picture render(const std::vector<Shape>& shapes, const std::vector<Texture>& textures,
               const PinholeCamera& camera, const Eigen::Isometry3d& T_room_camera) {
  std::vector<PlacedShape> placed;
  placed.reserve(shapes.size());
  for (const Shape& shape : shapes) placed.emplace_back(shape, T_room_camera.cast<float>(), camera);

  const cv::Size size(camera.width, camera.height);
  Picture picture{cv::Mat::zeros(size, CV_8UC3), cv::Mat::zeros(size, CV_32FC1),
                  cv::Mat::zeros(size, CV_8UC1)};
  const cv::Rect image({0, 0}, size);
  const int columns = (size.width + kTile - 1) / kTile, rows = (size.height + kTile - 1) / kTile;
  parallelFor(static_cast<std::size_t>(rows), 1, [&](std::size_t begin, std::size_t end) {
    Renderer renderer(textures, camera, picture);
    PlacedShapes here;
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      for (int column = 0; column < columns; ++column) {
        const cv::Rect tile = cv::Rect(column * kTile, row * kTile, kTile, kTile) & image;
        here.clear();
        for (const PlacedShape& shape : placed)
          if (!(shape.pixels() & tile).empty()) here.push_back(&shape);
        renderer.renderTile(tile, here);
      }
  });
  // A lens: edges cover a pixel or so, which also hides the stairs of one ray per pixel.
  cv::GaussianBlur(picture.color, picture.color, {3, 3}, 0.6);
  return picture;
}

}  // namespace pf::synthetic

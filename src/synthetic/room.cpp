// SPDX-License-Identifier: BSD-3-Clause
#include "room.hpp"

namespace pf::synthetic {
namespace {

/// A surface with `repeats` to the metre; every piece starts at another place of the pattern.
Material surface(Surface kind, float repeats) {
  static constexpr float kStep = 0.37F;
  const float offset = kStep * static_cast<float>(static_cast<int>(kind));
  return {kind, {repeats, repeats}, {offset, 2 * offset}};
}

/// A box standing with its lowest face's middle at `foot`, turned about the vertical.
Shape box(const Eigen::Vector3f& foot, const Eigen::Vector3f& size, const Material& material,
          float yaw = 0.0F) {
  Shape shape;
  shape.half = size / 2;
  shape.T_room_shape.translate(foot + Eigen::Vector3f(0, 0, size.z() / 2));
  shape.T_room_shape.rotate(Eigen::AngleAxisf(yaw, Eigen::Vector3f::UnitZ()));
  shape.materials.fill(material);
  const Eigen::Vector2f shift(0.61F * foot.x() + 0.17F * foot.z(), 0.43F * foot.y());
  for (Material& m : shape.materials) m.offset += shift;
  return shape;
}

/// Paints one face with a whole picture: one repeat from edge to edge.
void paintFace(Shape& shape, int face, Surface surface, float repeats_across = 1.0F) {
  const Eigen::Vector3f size = 2 * shape.half;
  const float across = face / 2 == 0 ? size.y() : size.x();
  const float along = face / 2 == 2 ? size.y() : size.z();
  shape.materials[static_cast<std::size_t>(face)] = {
      surface, {repeats_across / across, 1 / along}, {0, 0}};
}

Shape ball(const Eigen::Vector3f& centre, const Eigen::Vector3f& half, const Material& material) {
  Shape shape;
  shape.kind = ShapeKind::ellipsoid;
  shape.half = half;
  shape.T_room_shape.translate(centre);
  shape.materials.fill(material);
  return shape;
}

Shape shell() {
  Shape shape = box({2.6F, 2.3F, 0}, {5.2F, 4.6F, 2.6F}, surface(Surface::plaster, 0.5F));
  shape.kind = ShapeKind::inside_of_box;
  shape.materials[4] = surface(Surface::boards, 0.7F);
  shape.materials[5] = surface(Surface::ceiling, 0.4F);
  return shape;
}

void addTable(std::vector<Shape>& room, const Eigen::Vector3f& foot) {
  const Material wood = surface(Surface::wood, 0.9F);
  room.push_back(box(foot + Eigen::Vector3f(0, 0, 0.70F), {1.3F, 0.75F, 0.04F}, wood));
  for (const float x : {-0.58F, 0.58F})
    for (const float y : {-0.30F, 0.30F})
      room.push_back(box(foot + Eigen::Vector3f(x, y, 0), {0.06F, 0.06F, 0.70F}, wood));
  const Eigen::Vector3f top = foot + Eigen::Vector3f(0, 0, 0.74F);
  Shape parcel = box(top + Eigen::Vector3f(-0.35F, 0.1F, 0), {0.3F, 0.22F, 0.2F},
                     surface(Surface::cardboard, 1.5F), 0.4F);
  paintFace(parcel, 2, Surface::poster);
  room.push_back(parcel);
  room.push_back(box(top + Eigen::Vector3f(0.3F, -0.1F, 0), {0.25F, 0.18F, 0.05F},
                     surface(Surface::poster, 3), -0.5F));
  room.push_back(ball(top + Eigen::Vector3f(0.05F, 0.1F, 0.11F), {0.11F, 0.11F, 0.11F},
                      surface(Surface::checks, 2)));
}

void addChair(std::vector<Shape>& room, const Eigen::Vector3f& foot, float yaw) {
  const Material wood = surface(Surface::dark_wood, 1.2F);
  const Eigen::AngleAxisf turn(yaw, Eigen::Vector3f::UnitZ());
  const auto part = [&](const Eigen::Vector3f& at, const Eigen::Vector3f& size, const Material& m) {
    room.push_back(box(foot + turn * at, size, m, yaw));
  };
  part({0, 0, 0.42F}, {0.44F, 0.42F, 0.05F}, surface(Surface::fabric, 1.5F));
  part({0, 0.2F, 0.47F}, {0.44F, 0.04F, 0.48F}, wood);
  for (const float x : {-0.19F, 0.19F})
    for (const float y : {-0.18F, 0.18F}) part({x, y, 0}, {0.04F, 0.04F, 0.42F}, wood);
}

void addShelf(std::vector<Shape>& room, const Eigen::Vector3f& foot) {
  const Material wood = surface(Surface::dark_wood, 0.8F);
  const auto at = [&](float x, float z) {
    return Eigen::Vector3f(foot + Eigen::Vector3f(x, 0, z));
  };
  room.push_back(box(at(-0.61F, 0), {0.03F, 0.34F, 1.9F}, wood));
  room.push_back(box(at(0.61F, 0), {0.03F, 0.34F, 1.9F}, wood));
  for (int level = 0; level < 5; ++level) {
    const float z = 0.05F + 0.45F * static_cast<float>(level);
    room.push_back(box(at(0, z), {1.2F, 0.34F, 0.03F}, wood));
    if (level == 4) break;
    Shape books = box(at(level % 2 == 0 ? -0.1F : 0.08F, z + 0.03F), {0.95F, 0.24F, 0.32F}, wood);
    paintFace(books, 2, Surface::books);
    books.materials[2].offset = {0.31F * static_cast<float>(level), 0};
    room.push_back(books);
  }
}

void addSofa(std::vector<Shape>& room, const Eigen::Vector3f& foot) {
  const Material fabric = surface(Surface::fabric, 1.1F);
  room.push_back(box(foot, {0.85F, 1.8F, 0.42F}, fabric));
  room.push_back(box(foot + Eigen::Vector3f(0.32F, 0, 0.42F), {0.2F, 1.8F, 0.42F}, fabric));
  for (const float y : {-0.82F, 0.82F})
    room.push_back(box(foot + Eigen::Vector3f(-0.1F, y, 0.42F), {0.62F, 0.16F, 0.18F}, fabric));
  room.push_back(box(foot + Eigen::Vector3f(0.1F, 0.45F, 0.42F), {0.16F, 0.45F, 0.4F},
                     surface(Surface::checks, 2), 0.3F));
}

void addPictures(std::vector<Shape>& room) {
  Shape poster = box({1.35F, 4.585F, 1.15F}, {0.8F, 0.03F, 0.6F}, surface(Surface::wood, 2));
  paintFace(poster, 2, Surface::poster);
  Shape painting = box({2.75F, 4.58F, 1.2F}, {0.7F, 0.04F, 0.9F}, surface(Surface::dark_wood, 2));
  paintFace(painting, 2, Surface::painting);
  Shape left = box({0.015F, 2.9F, 1.1F}, {0.03F, 0.9F, 0.7F}, surface(Surface::wood, 2));
  paintFace(left, 1, Surface::painting);
  Shape right = box({5.185F, 2.3F, 1.3F}, {0.03F, 0.7F, 0.5F}, surface(Surface::wood, 2));
  paintFace(right, 0, Surface::poster);
  for (const Shape& picture : {poster, painting, left, right}) room.push_back(picture);
}

}  // namespace

std::vector<Shape> makeRoom() {
  std::vector<Shape> room = {shell()};
  Shape carpet = box({2.6F, 2.6F, 0}, {2.4F, 1.7F, 0.012F}, surface(Surface::carpet, 0.8F));
  room.push_back(carpet);
  addTable(room, {1.55F, 3.85F, 0});
  addChair(room, {1.2F, 3.3F, 0}, 3.4F);
  addChair(room, {2.35F, 4.0F, 0}, -1.2F);
  addShelf(room, {3.75F, 4.41F, 0});
  addSofa(room, {4.72F, 2.6F, 0});
  Shape cabinet = box({0.3F, 2.0F, 0}, {0.5F, 1.0F, 0.95F}, surface(Surface::wood, 0.8F));
  room.push_back(cabinet);
  room.push_back(
      box({0.3F, 1.8F, 0.95F}, {0.25F, 0.3F, 0.35F}, surface(Surface::cardboard, 1.4F), 0.3F));
  room.push_back(
      box({4.7F, 4.15F, 0}, {0.5F, 0.45F, 0.4F}, surface(Surface::cardboard, 1.2F), 0.2F));
  room.push_back(
      box({4.72F, 4.18F, 0.4F}, {0.35F, 0.35F, 0.3F}, surface(Surface::checks, 1.3F), -0.3F));
  room.push_back(ball({0.55F, 3.2F, 0.22F}, {0.22F, 0.22F, 0.22F}, surface(Surface::carpet, 1.2F)));
  addPictures(room);
  return room;
}

}  // namespace pf::synthetic

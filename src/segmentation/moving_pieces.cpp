// SPDX-License-Identifier: BSD-3-Clause
// Pieces of depth that may be moving objects.
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "moving_pieces.hpp"
#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

// Noise along an edge is one or two cells thin.
constexpr int kLeastThickness = 3;  // cells
// A surface (m2) smaller than a hand is no object.
constexpr double kLeastArea_m2 = 0.006;
constexpr float kCarriedOff_m = 0.15F;  // of an object's depth from where it was expected
constexpr float kEdgeSigmas = 3.0F;
constexpr float kEdgeSlope = 2.0F;  // depth per distance across, of neighbours on one surface

/// Whether a cell is not surely the map's.
bool isOpen(const MovingScene& scene, int cell) {
  const Background background = scene.background[cell];
  if (background == Background::agrees || background == Background::farther) return false;
  return scene.grid.hasDepth(cell);
}

}  // namespace

void MovingObjects::findOpenCells(const MovingScene& scene) {
  open_.clear();
  for (int cell = 0; cell < scene.grid.size(); ++cell) {
    if (isOpen(scene, cell)) open_.push_back(cell);
  }
}

/// Cells whose place was seen to be empty, as far as they are no noise along an edge.
void MovingObjects::findSeeds(const MovingScene& scene) {
  const SceneGrid& grid = scene.grid;
  seeds_.assign(grid.size(), 0);
  for (const int cell : open_) {
    const bool may_move =
        scene.is_person[cell] == 0 && scene.background[cell] != Background::recent;
    seeds_[cell] = may_move && before_.wasFree(cell) ? 1 : 0;
  }
  cv::Mat image(grid.rows, grid.cols, CV_8UC1, seeds_.data());
  const cv::Mat kernel = cv::Mat::ones(kLeastThickness, kLeastThickness, CV_8UC1);
  cv::morphologyEx(image, image, cv::MORPH_OPEN, kernel);
}

const std::vector<std::int16_t>& MovingObjects::expect(const MovingScene& scene) {
  before_.know(scene.view);
  findOpenCells(scene);
  before_.compare(scene.grid, open_, scene.T_uncorrected_camera, scene.stamp_ns, sensor_);
  const SceneGrid& grid = scene.grid;
  const PinholeCamera camera = scene.camera.shrunk(grid.step);
  const double elapsed_s = secondsBetween(last_ns_, scene.stamp_ns);
  const Eigen::Isometry3d T_camera_uncorrected = scene.T_uncorrected_camera.inverse();
  carried_.assign(grid.size(), -1);
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    const Eigen::Vector3d shift = objects_[k].object.velocity_m_s * elapsed_s;
    for (const Eigen::Vector3f& point : objects_[k].object.points_m) {
      const Eigen::Vector3d p = T_camera_uncorrected * (point.cast<double>() + shift);
      if (p.z() <= 0) continue;
      const Eigen::Vector2d pixel = camera.project(p);
      const int u = cvRound(pixel.x()), v = cvRound(pixel.y());
      if (u < 0 || v < 0 || u >= grid.cols || v >= grid.rows) continue;
      const int cell = v * grid.cols + u;
      if (std::abs(grid.z[cell] - static_cast<float>(p.z())) > kCarriedOff_m) continue;
      carried_[cell] = static_cast<std::int16_t>(k);
    }
  }
  return carried_;
}

/// Whether a piece may grow into the cell. Before the map, what moves slowly was partly where it is
/// now; elsewhere only what was not there yet is no part of the static world.
bool MovingObjects::isOfMoving(const MovingScene& scene, int cell) const {
  if (!isOpen(scene, cell) || scene.is_person[cell] != 0) return false;
  return scene.background[cell] == Background::nearer || !before_.wasThere(cell);
}

MovingObjects::Piece MovingObjects::growFrom(const MovingScene& scene, int first) {
  const SceneGrid& grid = scene.grid;
  Piece piece;
  piece.votes.assign(objects_.size(), 0);
  piece.cells.push_back(first);
  piece_of_[first] = 1;
  for (std::size_t next = 0; next < piece.cells.size(); ++next) {
    const int cell = piece.cells[next];
    const float z = grid.z[cell];
    const float side_m = grid.spacing * z;
    const float step_m = kEdgeSlope * side_m + kEdgeSigmas * sensor_.sigma(z);
    piece.area_m2 += static_cast<double>(side_m) * side_m;
    piece.seeds += seeds_[cell];
    if (carried_[cell] >= 0) ++piece.votes[carried_[cell]];
    for (std::size_t m = 0; m < piece.was_free.size(); ++m) {
      piece.was_free[m] += before_.moments()[m][cell] == Background::nearer ? 1 : 0;
      piece.was_there[m] += before_.moments()[m][cell] == Background::agrees ? 1 : 0;
    }
    const int u = cell % grid.cols, v = cell / grid.cols;
    const std::array<std::pair<int, int>, 4> around = {
        {{u - 1, v}, {u + 1, v}, {u, v - 1}, {u, v + 1}}};
    for (const auto& [x, y] : around) {
      if (x < 0 || y < 0 || x >= grid.cols || y >= grid.rows) continue;
      const int other = y * grid.cols + x;
      if (piece_of_[other] != 0 || std::abs(grid.z[other] - z) > step_m) continue;
      if (!isOfMoving(scene, other)) continue;
      piece_of_[other] = 1;
      piece.cells.push_back(other);
    }
  }
  return piece;
}

std::vector<MovingObjects::Piece> MovingObjects::grow(const MovingScene& scene) {
  std::vector<Piece> pieces;
  piece_of_.assign(scene.grid.size(), 0);
  for (int cell = 0; cell < scene.grid.size(); ++cell) {
    const bool is_start = seeds_[cell] != 0 || carried_[cell] >= 0;
    if (!is_start || piece_of_[cell] != 0 || !isOfMoving(scene, cell)) continue;
    Piece piece = growFrom(scene, cell);
    if (piece.area_m2 >= kLeastArea_m2) pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace pf

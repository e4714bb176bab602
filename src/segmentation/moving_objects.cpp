// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/moving_objects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "posefusion/core/pace.hpp"
#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

// Noise along an edge is one or two cells thin.
constexpr int kLeastThickness = 3;  // cells
// A surface (m2) smaller than a hand is no object.
constexpr double kLeastArea_m2 = 0.006;
constexpr int kLeastSeeds = 12;
// Part of a piece's known cells whose place was empty at an earlier moment: moving objects have
// more, static ones less.
constexpr double kMovingPart = 0.10;
// A moment counts for a piece if it knows this part of its cells.
constexpr double kKnownPart = 0.2;
// Of what goes on as it went, the nearest moment shows its part; of what has stopped since less
// than this of that.
constexpr double kGoesOn = 0.5;
// Evidence is no more than this (frames at 30 Hz): what has come to rest counts as static after
// half a second without any.
constexpr double kMostOdds = 15.0;
constexpr double kUnseen_s = 0.5;       // until an object that is not found is given up
constexpr float kCarriedOff_m = 0.15F;  // of an object's depth from where it was expected
constexpr float kEdgeSigmas = 3.0F;
constexpr float kEdgeSlope = 2.0F;  // depth per distance across, of neighbours on one surface

/// What a frame's evidence counts for, in frames at 30 Hz: it is of the time since the frame
/// before, blurred ones left out, as far as the nearest moment reaches back.
double weightOf(double elapsed_s) {
  return Pace{std::min(elapsed_s, SeenBefore::kAges_s.front())}.worth();
}

}  // namespace

/// A connected piece of depth that may be a moving object.
struct MovingObjects::Piece {
  std::vector<int> cells;
  int seeds = 0;
  double area_m2 = 0;
  std::array<int, SeenBefore::kAges_s.size()> was_free{}, was_there{};
  std::vector<int> votes;  ///< cells that each object was expected in
};

/// An object from frame to frame.
struct MovingObjects::Followed {
  MovingObject object;
  double odds = 0;         ///< for moving, in frames (at 30 Hz) of evidence; given up at 0
  double unseen_s = 0;     ///< since it was last found
  std::vector<int> cells;  ///< of the grid, in the newest frame
};

MovingObjects::MovingObjects(const DepthSensor& sensor) : sensor_(sensor) {}
MovingObjects::~MovingObjects() = default;

void MovingObjects::reset() {
  before_.reset();
  objects_.clear();
  labels_.clear();
}

/// Cells that may be of something that moves: neither a person's nor surely the map's.
void MovingObjects::findOpenCells(const MovingScene& scene) {
  open_.clear();
  for (int cell = 0; cell < scene.grid.size(); ++cell) {
    const Background background = scene.background[cell];
    if (background == Background::agrees || background == Background::farther) continue;
    if (scene.grid.hasDepth(cell) && scene.is_person[cell] == 0) open_.push_back(cell);
  }
}

/// Cells whose place was seen to be empty, as far as they are no noise along an edge.
void MovingObjects::findSeeds(const MovingScene& scene) {
  const SceneGrid& grid = scene.grid;
  seeds_.assign(grid.size(), 0);
  for (const int cell : open_) {
    seeds_[cell] = scene.background[cell] != Background::recent && before_.wasFree(cell) ? 1 : 0;
  }
  cv::Mat image(grid.rows, grid.cols, CV_8UC1, seeds_.data());
  const cv::Mat kernel = cv::Mat::ones(kLeastThickness, kLeastThickness, CV_8UC1);
  cv::morphologyEx(image, image, cv::MORPH_OPEN, kernel);
}

/// Where the objects of the last frame are to be expected.
void MovingObjects::carryObjects(const MovingScene& scene) {
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
}

/// Whether a piece may grow into the cell. Before the map, what moves slowly was partly where it is
/// now; elsewhere only what was not there yet is no part of the static world.
bool MovingObjects::isOfMoving(const MovingScene& scene, int cell) const {
  if (!scene.grid.hasDepth(cell) || scene.is_person[cell] != 0) return false;
  switch (scene.background[cell]) {
    case Background::nearer:
      return true;
    case Background::unknown:
    case Background::recent:
      return !before_.wasThere(cell);
    default:
      return false;
  }
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

/// For (1) or against (-1) that a piece moves, by the moment that speaks most for it: what is slow
/// or has just begun shows at one of them. Against it where the nearest moment shows that it has
/// stopped since.
double MovingObjects::evidenceOf(const Piece& piece) const {
  double most = -1.0, rate = 0.0, nearest_s = 0.0, nearest = 0.0;
  for (std::size_t m = 0; m < piece.was_free.size(); ++m) {
    const double known = piece.was_free[m] + piece.was_there[m];
    if (known < kKnownPart * static_cast<double>(piece.cells.size())) continue;
    const double free = piece.was_free[m] / known;
    if (nearest_s == 0.0) {
      nearest_s = SeenBefore::kAges_s[m];
      nearest = free;
    }
    rate = std::max(rate, free / SeenBefore::kAges_s[m]);
    most = std::max(most, (free - kMovingPart) / kMovingPart);
  }
  if (nearest_s == 0.0) return 0.0;
  if (nearest < kGoesOn * rate * nearest_s) return -1.0;
  return std::clamp(most, -1.0, 1.0);
}

/// The object is where the piece is.
void MovingObjects::place(const MovingScene& scene, double elapsed_s, Piece& piece,
                          Followed& object) {
  object.cells = std::move(piece.cells);
  std::vector<Eigen::Vector3f> points_m;
  for (const int cell : object.cells) {
    const Eigen::Vector3d p = scene.T_uncorrected_camera * scene.grid.point(cell).cast<double>();
    points_m.emplace_back(p.cast<float>());
  }
  object.object.placeAt(std::move(points_m), elapsed_s);
}

/// Each object goes on in the largest piece that lies where it was expected; what is left is new
/// where enough of it stands in places that were empty.
void MovingObjects::follow(const MovingScene& scene, std::vector<Piece>& pieces, double elapsed_s) {
  std::vector<bool> is_taken(pieces.size(), false);
  for (std::size_t k = 0; k < objects_.size(); ++k) {
    Followed& object = objects_[k];
    object.unseen_s += elapsed_s;
    int best = -1;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (is_taken[i] || pieces[i].votes[k] == 0) continue;
      if (best < 0 || pieces[i].votes[k] > pieces[best].votes[k]) best = static_cast<int>(i);
    }
    if (best < 0) {
      object.cells.clear();
      continue;
    }
    is_taken[best] = true;
    object.unseen_s = 0;
    object.odds = std::min(kMostOdds, object.odds + weightOf(elapsed_s) * evidenceOf(pieces[best]));
    place(scene, elapsed_s, pieces[best], object);
  }
  const auto isOver = [](const Followed& o) { return o.odds <= 0 || o.unseen_s > kUnseen_s; };
  objects_.erase(std::remove_if(objects_.begin(), objects_.end(), isOver), objects_.end());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const double evidence = evidenceOf(pieces[i]);
    if (is_taken[i] || pieces[i].seeds < kLeastSeeds || evidence <= 0) continue;
    Followed object;
    object.object.id = ++last_id_;
    object.odds = weightOf(elapsed_s) * evidence;
    place(scene, 0, pieces[i], object);
    objects_.push_back(std::move(object));
  }
}

std::vector<MovingObject> MovingObjects::find(const MovingScene& scene) {
  before_.know(scene.view);
  findOpenCells(scene);
  before_.compare(scene.grid, open_, scene.T_uncorrected_camera, scene.stamp_ns, sensor_);
  const double elapsed_s = std::max(0.0, secondsBetween(last_ns_, scene.stamp_ns));
  findSeeds(scene);
  carryObjects(scene);
  std::vector<Piece> pieces = grow(scene);
  follow(scene, pieces, elapsed_s);
  labels_.assign(scene.grid.size(), 0);
  std::vector<MovingObject> found;
  for (const Followed& followed : objects_) {
    for (const int cell : followed.cells) labels_[cell] = 1;
    if (!followed.cells.empty()) found.push_back(followed.object);
  }
  before_.add(scene.grid, scene.camera, scene.stamp_ns);
  last_ns_ = scene.stamp_ns;
  return found;
}

}  // namespace pf

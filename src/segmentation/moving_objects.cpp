// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/moving_objects.hpp"

#include <algorithm>
#include <utility>

#include "moving_pieces.hpp"
#include "posefusion/core/pace.hpp"
#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

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
constexpr double kUnseen_s = 0.5;  // until an object that is not found is given up

/// What a frame's evidence counts for, in frames at 30 Hz: it is of the time since the frame
/// before, blurred ones left out, as far as the nearest moment reaches back.
double weightOf(double elapsed_s) {
  return Pace{std::min(elapsed_s, SeenBefore::kAges_s.front())}.worth();
}

}  // namespace

MovingObjects::MovingObjects(const DepthSensor& sensor) : sensor_(sensor) {}
MovingObjects::~MovingObjects() = default;

void MovingObjects::reset() {
  before_.reset();
  objects_.clear();
  labels_.clear();
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
  const double elapsed_s = std::max(0.0, secondsBetween(last_ns_, scene.stamp_ns));
  findSeeds(scene);
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

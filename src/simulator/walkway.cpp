// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/walkway.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace pf::simulator {
namespace {

using Eigen::Vector2d;

constexpr double kCell_m = 0.1;
constexpr double kBody_m = 0.13;  // that a body keeps from walls at the least

bool covers(const Footprint& f, const Vector2d& p, double margin_m) {
  const double c = std::cos(f.yaw), s = std::sin(f.yaw);
  const Vector2d d = p - f.centre;
  const Vector2d local(c * d.x() + s * d.y(), -s * d.x() + c * d.y());
  const Vector2d beyond = (local.cwiseAbs() - f.half_size).cwiseMax(0.0);
  return beyond.norm() <= margin_m;
}

}  // namespace

Walkway::Walkway(const World& world, double clearance_m)
    : rooms_(world.rooms), passages_(world.passages) {
  Eigen::AlignedBox3d box;
  for (const auto& room : world.rooms) box.extend(room);
  if (box.isEmpty()) return;
  low_ = box.min().head<2>();
  columns_ = std::max(1, static_cast<int>(std::ceil(box.sizes().x() / kCell_m)));
  rows_ = std::max(1, static_cast<int>(std::ceil(box.sizes().y() / kCell_m)));
  free_.assign(static_cast<std::size_t>(columns_ * rows_), 0);
  for (int cell = 0; cell < columns_ * rows_; ++cell) {
    const Vector2d p = centreOf(cell);
    for (const auto& room : world.rooms) {
      const Vector2d inside = (p - room.min().head<2>()).cwiseMin(room.max().head<2>() - p);
      if (inside.minCoeff() > clearance_m) free_[static_cast<std::size_t>(cell)] = 1;
    }
    for (const auto& passage : world.passages) {
      if (covers(passage, p, 0.0)) free_[static_cast<std::size_t>(cell)] = 1;
    }
    for (const auto& footprint : world.footprints) {
      if (covers(footprint, p, clearance_m)) free_[static_cast<std::size_t>(cell)] = 0;
    }
  }
}

int Walkway::cellAt(const Vector2d& p) const {
  const int col = static_cast<int>(std::floor((p.x() - low_.x()) / kCell_m));
  const int row = static_cast<int>(std::floor((p.y() - low_.y()) / kCell_m));
  if (col < 0 || row < 0 || col >= columns_ || row >= rows_) return -1;
  return row * columns_ + col;
}

Vector2d Walkway::centreOf(int cell) const {
  return low_ + kCell_m * Vector2d(cell % columns_ + 0.5, cell / columns_ + 0.5);
}

bool Walkway::isFree(const Vector2d& p) const {
  const int cell = cellAt(p);
  return cell >= 0 && !free_.empty() && free_[static_cast<std::size_t>(cell)] != 0;
}

bool Walkway::isFloor(const Vector2d& p) const {
  const auto has_room = [&](const auto& room) {
    return (p - room.min().template head<2>()).minCoeff() > kBody_m &&
           (room.max().template head<2>() - p).minCoeff() > kBody_m;
  };
  return std::any_of(rooms_.begin(), rooms_.end(), has_room) ||
         std::any_of(passages_.begin(), passages_.end(),
                     [&](const Footprint& passage) { return covers(passage, p, kBody_m); });
}

Vector2d Walkway::nearestFree(const Vector2d& p) const {
  if (isFree(p) || free_.empty()) return p;
  double best = std::numeric_limits<double>::infinity();
  Vector2d place = p;
  for (int cell = 0; cell < columns_ * rows_; ++cell) {
    if (free_[static_cast<std::size_t>(cell)] == 0) continue;
    const double d = (centreOf(cell) - p).squaredNorm();
    if (d < best) best = d, place = centreOf(cell);
  }
  return place;
}

bool Walkway::seesFree(const Vector2d& a, const Vector2d& b) const {
  const int steps = std::max(1, static_cast<int>((b - a).norm() / (0.1 * kCell_m)));
  for (int i = 0; i <= steps; ++i) {
    if (!isFree(a + (b - a) * (static_cast<double>(i) / steps))) return false;
  }
  return true;
}

std::vector<int> Walkway::freeAround(int cell) const {
  std::vector<int> cells;
  for (int dr = -1; dr <= 1; ++dr) {
    for (int dc = -1; dc <= 1; ++dc) {
      const int col = cell % columns_ + dc, row = cell / columns_ + dr;
      if (col < 0 || row < 0 || col >= columns_ || row >= rows_) continue;
      const int next = row * columns_ + col;
      if (free_[static_cast<std::size_t>(next)] != 0) cells.push_back(next);
    }
  }
  return cells;
}

void Walkway::keepReachable(const Vector2d& from) {
  const int start = cellAt(nearestFree(from));
  if (start < 0) return;
  std::vector<char> reached(free_.size(), 0);
  std::vector<int> open{start};
  reached[static_cast<std::size_t>(start)] = 1;
  while (!open.empty()) {
    const int cell = open.back();
    open.pop_back();
    for (const int next : freeAround(cell)) {
      if (reached[static_cast<std::size_t>(next)] != 0) continue;
      reached[static_cast<std::size_t>(next)] = 1;
      open.push_back(next);
    }
  }
  free_ = std::move(reached);
}

std::vector<int> Walkway::search(int from, int to) const {
  // A* with the straight distance; ties by cell number, so the way is always the same.
  std::vector<double> cost(free_.size(), std::numeric_limits<double>::infinity());
  std::vector<int> parent(free_.size(), -1);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[static_cast<std::size_t>(from)] = 0.0;
  open.emplace(0.0, from);
  while (!open.empty()) {
    const int cell = open.top().second;
    open.pop();
    if (cell == to) break;
    for (const int next : freeAround(cell)) {
      const double dr = next / columns_ - cell / columns_, dc = next % columns_ - cell % columns_;
      const double g = cost[static_cast<std::size_t>(cell)] + std::hypot(dr, dc);
      if (g >= cost[static_cast<std::size_t>(next)] - 1e-9) continue;
      cost[static_cast<std::size_t>(next)] = g;
      parent[static_cast<std::size_t>(next)] = cell;
      open.emplace(g + (centreOf(next) - centreOf(to)).norm() / kCell_m, next);
    }
  }
  std::vector<int> cells;
  if (parent[static_cast<std::size_t>(to)] < 0) return cells;
  for (int cell = to; cell >= 0; cell = parent[static_cast<std::size_t>(cell)])
    cells.push_back(cell);
  std::reverse(cells.begin(), cells.end());
  return cells;
}

bool Walkway::connects(const Vector2d& from, const Vector2d& to) const {
  const Vector2d start = nearestFree(from), goal = nearestFree(to);
  if (cellAt(start) < 0 || cellAt(goal) < 0) return false;
  return seesFree(start, goal) || !search(cellAt(start), cellAt(goal)).empty();
}

std::vector<Vector2d> Walkway::findWay(const Vector2d& from, const Vector2d& to) const {
  const Vector2d start = nearestFree(from), goal = nearestFree(to);
  std::vector<Vector2d> way{from};
  if (!isFree(from)) way.push_back(start);
  if (!seesFree(start, goal) && cellAt(start) >= 0 && cellAt(goal) >= 0) {
    const std::vector<int> cells = search(cellAt(start), cellAt(goal));
    Vector2d corner = start;
    for (std::size_t i = 1; i < cells.size(); ++i) {
      if (seesFree(corner, centreOf(cells[i]))) continue;
      corner = centreOf(cells[i - 1]);
      way.push_back(corner);
    }
  }
  if (!isFree(to)) way.push_back(goal);
  way.push_back(to);
  return way;
}

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "posefusion/simulator/avatar.hpp"
#include "posefusion/simulator/raycaster.hpp"

namespace posefusion::simulator {

/// A person during one frame: from its first to its last moment.
struct Movement {
  Posture first, middle, last;
  Eigen::Vector2f at;  ///< the place of the floor where the person stands in the middle
};

/// The people as they are during one frame, for rays (geometry 1 + index): they move linearly
/// between two shapes, time 0 and time 1 of a ray. Tracing is thread safe, posing is not.
class PosedPeople {
 public:
  /// `world` gives the device, `people` the surfaces; both must outlive this.
  PosedPeople(const RayCaster& world, const std::vector<Avatar>& people);
  ~PosedPeople();
  PosedPeople(const PosedPeople&) = delete;
  PosedPeople& operator=(const PosedPeople&) = delete;

  void pose(const std::vector<Movement>& movements);

  /// Hits that are nearer than those in the packet.
  void trace(RayPacket& packet) const;
  /// Whether anybody is between the two points, apart from `margin_m` at both ends.
  bool block(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float margin_m) const;

  std::size_t size() const { return people_.size(); }
  const Avatar& avatar(std::size_t person) const { return people_[person]; }
  /// Where each stands on the floor.
  const std::vector<Eigen::Vector2f>& places() const { return places_; }
  /// Vertices and their normals in the middle of the frame, world.
  const std::vector<Eigen::Vector3f>& positions(std::size_t person) const {
    return positions_[person];
  }
  const std::vector<Eigen::Vector3f>& normals(std::size_t person) const { return normals_[person]; }

 private:
  struct State;

  const std::vector<Avatar>& people_;
  std::vector<Eigen::Vector2f> places_;
  std::vector<std::vector<Eigen::Vector3f>> positions_, normals_;
  std::unique_ptr<State> state_;
};

}  // namespace posefusion::simulator

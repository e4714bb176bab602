// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "simulator/avatar.hpp"
#include "simulator/raycaster.hpp"

namespace pf::simulator {

/// The postures of all people at one moment.
using Postures = std::vector<Posture>;

/// The people as they are during one picture, for rays (geometry 1 + index): still, with one shape,
/// or moving linearly between two, time 0 and time 1 of a ray. Tracing is thread safe, posing is
/// not.
class PosedPeople {
 public:
  /// `world` gives the device, `people` the surfaces; both must outlive this.
  PosedPeople(const RayCaster& world, const std::vector<Avatar>& people, unsigned shapes);
  ~PosedPeople();
  PosedPeople(PosedPeople&&) noexcept;

  /// Two shapes or more: those of the first and the last moment.
  bool moves() const;
  /// Postures for each shape.
  void pose(const std::vector<Postures>& shapes);

  /// Hits that are nearer than those in the packet.
  void trace(RayPacket& packet) const;
  /// As RayCaster::blocks(), in the middle of the time.
  std::array<bool, 16> block(const SightPacket& sight, float margin_m) const;

  const Avatar& avatar(std::size_t person) const { return people_[person]; }

 private:
  struct State;

  const std::vector<Avatar>& people_;
  std::unique_ptr<State> state_;
};

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "simulator/avatar.hpp"
#include "simulator/raycaster.hpp"
#include "simulator/thing.hpp"

namespace pf::simulator {

/// The postures of all people at one moment.
using Postures = std::vector<Posture>;

/// All that moves at one moment.
struct MoverPoses {
  Postures people;
  std::vector<ThingPose> things{};
};

/// The people and things as they are during one picture, for rays (geometry 1 + index of a person,
/// kFirstThing + index of a thing): still, with one shape, or moving linearly between two, time 0
/// and time 1 of a ray. Tracing is thread safe, posing is not.
class PosedMovers {
 public:
  /// `world` gives the device, `people` and `things` the surfaces; all must outlive this.
  PosedMovers(const RayCaster& world, const std::vector<Avatar>& people,
              const std::vector<ThingShape>& things, unsigned shapes);
  ~PosedMovers();
  PosedMovers(PosedMovers&&) noexcept;

  /// Two shapes or more: those of the first and the last moment.
  bool moves() const;
  /// Poses for each shape.
  void pose(const std::vector<MoverPoses>& shapes);

  /// Hits that are nearer than those in the packet.
  void trace(RayPacket& packet) const;
  /// As RayCaster::blocks(), in the middle of the time.
  std::array<bool, 16> block(const SightPacket& sight, float margin_m) const;

  const Avatar& avatar(std::size_t person) const { return people_[person]; }
  const Mesh& thing(std::size_t index) const { return things_[index].mesh; }

 private:
  struct State;
  bool isEmpty() const { return people_.empty() && things_.empty(); }

  const std::vector<Avatar>& people_;
  const std::vector<ThingShape>& things_;
  std::unique_ptr<State> state_;
};

}  // namespace pf::simulator

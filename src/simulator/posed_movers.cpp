// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/posed_movers.hpp"

#include <algorithm>

#include "embree.hpp"

namespace pf::simulator {
namespace {

/// Vertices of a thing at a pose: x y z each.
void place(const Mesh& mesh, const ThingPose& pose, float* positions) {
  const Eigen::Isometry3f T = pose.matrix().cast<float>();
  for (const Eigen::Vector3f& p : mesh.positions) {
    const Eigen::Vector3f moved = T * p;
    positions = std::copy_n(moved.data(), 3, positions);
  }
}

}  // namespace

struct PosedMovers::State {
  struct Body {
    RTCGeometry geometry = nullptr;  // the scene's
    std::vector<float*> shapes;

    void commit() const {
      for (unsigned shape = 0; shape < shapes.size(); ++shape) {
        rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, shape);
      }
      rtcCommitGeometry(geometry);
    }
  };
  ScenePointer scene;
  std::vector<Body> persons, things;

  Body add(RTCDevice device, const std::vector<std::array<std::uint32_t, 3>>& triangles,
           const std::vector<Eigen::Vector3f>& rest, unsigned shapes, std::uint32_t id) const {
    Body body;
    body.geometry = makeTriangles(device, triangles, shapes);
    // The tree of the body at rest, made here, is then only fitted to the shapes: 30 times faster
    // than building one. Embree cannot do that with moving triangles.
    rtcSetGeometryBuildQuality(body.geometry, RTC_BUILD_QUALITY_REFIT);
    for (unsigned shape = 0; shape < shapes; ++shape) {
      body.shapes.push_back(makeVertices(body.geometry, shape, rest.size()));
      std::copy_n(rest[0].data(), 3 * rest.size(), body.shapes.back());
    }
    rtcCommitGeometry(body.geometry);
    rtcAttachGeometryByID(scene.get(), body.geometry, id);
    rtcReleaseGeometry(body.geometry);
    return body;
  }
};

PosedMovers::PosedMovers(const RayCaster& world, const std::vector<Avatar>& people,
                         const std::vector<ThingShape>& things, unsigned shapes)
    : people_(people), things_(things), state_(std::make_unique<State>()) {
  RTCScene scene = rtcNewScene(world.device());
  state_->scene.reset(scene);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
  // A tree for each body, under one more.
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
  State& s = *state_;
  for (const Avatar& avatar : people) {
    const auto id = static_cast<std::uint32_t>(s.persons.size()) + 1U;
    s.persons.push_back(s.add(world.device(), avatar.triangles(), avatar.rest(), shapes, id));
  }
  for (const ThingShape& thing : things) {
    const auto id = static_cast<std::uint32_t>(s.things.size()) + kFirstThing;
    s.things.push_back(
        s.add(world.device(), thing.mesh.triangles, thing.mesh.positions, shapes, id));
  }
  buildTree(scene);
}

PosedMovers::~PosedMovers() = default;
PosedMovers::PosedMovers(PosedMovers&&) noexcept = default;

bool PosedMovers::moves() const {
  const auto& bodies = state_->persons.empty() ? state_->things : state_->persons;
  return !bodies.empty() && bodies[0].shapes.size() > 1;
}

void PosedMovers::pose(const std::vector<MoverPoses>& shapes) {
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const State::Body& person = state_->persons[i];
    for (std::size_t shape = 0; shape < person.shapes.size(); ++shape) {
      people_[i].skin(shapes[shape].people[i], person.shapes[shape]);
    }
    person.commit();
  }
  for (std::size_t i = 0; i < things_.size(); ++i) {
    const State::Body& thing = state_->things[i];
    for (std::size_t shape = 0; shape < thing.shapes.size(); ++shape) {
      place(things_[i].mesh, shapes[shape].things[i], thing.shapes[shape]);
    }
    thing.commit();
  }
  buildTree(state_->scene.get());
}

void PosedMovers::trace(RayPacket& packet) const {
  if (!isEmpty()) intersect(state_->scene.get(), packet);
}

std::array<bool, 16> PosedMovers::block(const SightPacket& sight, float margin_m) const {
  if (isEmpty()) return {};
  return blocks(state_->scene.get(), sight, margin_m);
}

}  // namespace pf::simulator

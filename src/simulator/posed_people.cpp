// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/posed_people.hpp"

#include <algorithm>

#include "embree.hpp"

namespace pf::simulator {

struct PosedPeople::State {
  struct Person {
    RTCGeometry geometry = nullptr;  // the scene's
    std::vector<float*> shapes;
  };
  ScenePointer scene;
  std::vector<Person> persons;
};

PosedPeople::PosedPeople(const RayCaster& world, const std::vector<Avatar>& people, unsigned shapes)
    : people_(people), state_(std::make_unique<State>()) {
  RTCScene scene = rtcNewScene(world.device());
  state_->scene.reset(scene);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
  // A tree for each person, under one more.
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
  for (const Avatar& avatar : people) {
    State::Person person;
    person.geometry = makeTriangles(world.device(), avatar.triangles(), shapes);
    // The tree of the standing body, made here, is then only fitted to the shapes: 30 times faster
    // than building one. Embree cannot do that with moving triangles.
    rtcSetGeometryBuildQuality(person.geometry, RTC_BUILD_QUALITY_REFIT);
    for (unsigned shape = 0; shape < shapes; ++shape) {
      person.shapes.push_back(makeVertices(person.geometry, shape, avatar.vertexCount()));
      std::copy_n(avatar.rest()[0].data(), 3 * avatar.vertexCount(), person.shapes.back());
    }
    rtcCommitGeometry(person.geometry);
    state_->persons.push_back(person);
    rtcAttachGeometryByID(scene, person.geometry, static_cast<unsigned>(state_->persons.size()));
    rtcReleaseGeometry(person.geometry);
  }
  buildTree(scene);
}

PosedPeople::~PosedPeople() = default;
PosedPeople::PosedPeople(PosedPeople&&) noexcept = default;

bool PosedPeople::moves() const {
  return !state_->persons.empty() && state_->persons[0].shapes.size() > 1;
}

void PosedPeople::pose(const std::vector<Postures>& shapes) {
  for (std::size_t i = 0; i < people_.size(); ++i) {
    const State::Person& person = state_->persons[i];
    for (unsigned shape = 0; shape < person.shapes.size(); ++shape) {
      people_[i].skin(shapes[shape][i], person.shapes[shape]);
      rtcUpdateGeometryBuffer(person.geometry, RTC_BUFFER_TYPE_VERTEX, shape);
    }
    rtcCommitGeometry(person.geometry);
  }
  buildTree(state_->scene.get());
}

void PosedPeople::trace(RayPacket& packet) const {
  if (!people_.empty()) intersect(state_->scene.get(), packet);
}

std::array<bool, 16> PosedPeople::block(const SightPacket& sight, float margin_m) const {
  if (people_.empty()) return {};
  return blocks(state_->scene.get(), sight, margin_m);
}

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/simulator/posed_people.hpp"

#include "embree.hpp"

namespace posefusion::simulator {

struct PosedPeople::State {
  struct Person {
    RTCGeometry geometry = nullptr;  // the scene's
    std::array<float*, 2> shapes{};
  };
  ScenePointer scene;
  std::vector<Person> persons;
};

PosedPeople::PosedPeople(const RayCaster& world, const std::vector<Avatar>& people)
    : people_(people),
      positions_(people.size()),
      normals_(people.size()),
      state_(std::make_unique<State>()) {
  RTCScene scene = rtcNewScene(world.device());
  state_->scene.reset(scene);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
  for (const Avatar& avatar : people) {
    State::Person person;
    person.geometry = makeTriangles(world.device(), avatar.triangles(), 2);
    rtcSetGeometryBuildQuality(person.geometry, RTC_BUILD_QUALITY_LOW);
    for (unsigned time = 0; time < 2; ++time) {
      person.shapes[time] = makeVertices(person.geometry, time, avatar.vertexCount());
    }
    state_->persons.push_back(person);
    rtcAttachGeometryByID(scene, person.geometry, static_cast<unsigned>(state_->persons.size()));
    rtcReleaseGeometry(person.geometry);
  }
}

PosedPeople::~PosedPeople() = default;

void PosedPeople::pose(const std::vector<Movement>& movements) {
  places_.clear();
  for (std::size_t i = 0; i < movements.size(); ++i) {
    const Movement& m = movements[i];
    const State::Person& person = state_->persons[i];
    people_[i].skin(m.first, person.shapes[0]);
    people_[i].skin(m.last, person.shapes[1]);
    positions_[i].resize(people_[i].vertexCount());
    people_[i].skin(m.middle, positions_[i][0].data());
    people_[i].skinNormals(m.middle, normals_[i]);
    places_.push_back(m.at);
    for (unsigned time = 0; time < 2; ++time) {
      rtcUpdateGeometryBuffer(person.geometry, RTC_BUFFER_TYPE_VERTEX, time);
    }
    rtcCommitGeometry(person.geometry);
  }
  buildTree(state_->scene.get());
}

void PosedPeople::trace(RayPacket& packet) const {
  if (people_.empty()) return;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(packet.valid, state_->scene.get(), &context, &packet.rays);
}

bool PosedPeople::block(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float margin_m) const {
  return !people_.empty() && blocks(state_->scene.get(), a, b, margin_m);
}

}  // namespace posefusion::simulator

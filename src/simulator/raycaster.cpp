// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/simulator/raycaster.hpp"

#include <tbb/task_arena.h>

#include <array>
#include <limits>
#include <stdexcept>

namespace posefusion::simulator {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

void copyTriangles(RTCGeometry geometry,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  auto* target = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), triangles.size()));
  for (const auto& triangle : triangles) {
    for (const std::uint32_t vertex : triangle) *target++ = vertex;
  }
}

float* newVertices(RTCGeometry geometry, unsigned slot, std::size_t count) {
  return static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, slot,
                                                     RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
}

/// In one thread: the tree, and with it ties between neighbours, is always the same.
void buildTree(RTCScene scene) {
  tbb::task_arena one_thread(1);
  one_thread.execute([scene] { rtcCommitScene(scene); });
}

bool blocks(RTCScene scene, const Eigen::Vector3f& a, const Eigen::Vector3f& b, float margin_m) {
  const Eigen::Vector3f d = b - a;
  const float length = d.norm();
  if (length <= 2.0F * margin_m) return false;
  RTCRay ray{};
  ray.org_x = a.x(), ray.org_y = a.y(), ray.org_z = a.z();
  ray.dir_x = d.x(), ray.dir_y = d.y(), ray.dir_z = d.z();
  ray.tnear = margin_m / length;
  ray.tfar = 1.0F - margin_m / length;
  ray.time = 0.5F;
  ray.mask = 0xFFFFFFFFU;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0.0F;
}

}  // namespace

struct RayCaster::State {
  RTCDevice device = nullptr;
  RTCScene world = nullptr;
  RTCScene people = nullptr;
  struct Person {
    RTCGeometry geometry = nullptr;
    std::array<float*, 2> vertices{};
  };
  std::vector<Person> persons;
};

RayCaster::RayCaster(const Mesh& world) : state_(std::make_unique<State>()) {
  State& s = *state_;
  // Not "threads=1": that would hold everything that uses TBB in this process to one thread.
  s.device = rtcNewDevice(nullptr);
  if (s.device == nullptr) throw std::runtime_error("Embree cannot be started");
  s.world = rtcNewScene(s.device);
  RTCGeometry geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float* vertices = newVertices(geometry, 0, world.positions.size());
  for (const auto& p : world.positions) {
    for (int i = 0; i < 3; ++i) *vertices++ = p[i];
  }
  copyTriangles(geometry, world.triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(s.world, geometry, 0);
  rtcReleaseGeometry(geometry);
  buildTree(s.world);
  s.people = rtcNewScene(s.device);
  rtcSetSceneFlags(s.people, RTC_SCENE_FLAG_DYNAMIC);
  rtcSetSceneBuildQuality(s.people, RTC_BUILD_QUALITY_LOW);
  buildTree(s.people);
}

RayCaster::~RayCaster() {
  for (const auto& person : state_->persons) rtcReleaseGeometry(person.geometry);
  rtcReleaseScene(state_->people);
  rtcReleaseScene(state_->world);
  rtcReleaseDevice(state_->device);
}

int RayCaster::addPerson(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                         std::size_t vertex_count) {
  State& s = *state_;
  State::Person person;
  person.geometry = rtcNewGeometry(s.device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(person.geometry, RTC_BUILD_QUALITY_LOW);
  rtcSetGeometryTimeStepCount(person.geometry, 2);
  for (unsigned slot = 0; slot < 2; ++slot) {
    person.vertices[slot] = newVertices(person.geometry, slot, vertex_count);
  }
  copyTriangles(person.geometry, triangles);
  s.persons.push_back(person);
  rtcAttachGeometryByID(s.people, person.geometry, static_cast<unsigned>(s.persons.size()));
  return static_cast<int>(s.persons.size()) - 1;
}

float* RayCaster::shape(int person, int time) {
  return state_->persons[static_cast<std::size_t>(person)].vertices[static_cast<std::size_t>(time)];
}

void RayCaster::setVisible(int person, bool visible) {
  RTCGeometry geometry = state_->persons[static_cast<std::size_t>(person)].geometry;
  visible ? rtcEnableGeometry(geometry) : rtcDisableGeometry(geometry);
}

void RayCaster::commitPeople() {
  for (const auto& person : state_->persons) {
    for (unsigned slot = 0; slot < 2; ++slot) {
      rtcUpdateGeometryBuffer(person.geometry, RTC_BUFFER_TYPE_VERTEX, slot);
    }
    rtcCommitGeometry(person.geometry);
  }
  buildTree(state_->people);
}

void RayCaster::trace(RayPacket& packet) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (int i = 0; i < 16; ++i) {
    packet.rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.rays.ray.mask[i] = 0xFFFFFFFFU;
    packet.rays.ray.flags[i] = 0;
  }
  rtcIntersect16(packet.valid, state_->world, &context, &packet.rays);
  if (!state_->persons.empty()) {
    rtcIntersect16(packet.valid, state_->people, &context, &packet.rays);
  }
}

void RayCaster::traceWorld(RTCRayHit& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  ray.ray.tfar = kInfinity;
  ray.ray.mask = 0xFFFFFFFFU;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->world, &context, &ray);
}

bool RayCaster::worldBlocks(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                            float margin_m) const {
  return blocks(state_->world, a, b, margin_m);
}

bool RayCaster::peopleBlock(const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                            float margin_m) const {
  return !state_->persons.empty() && blocks(state_->people, a, b, margin_m);
}

}  // namespace posefusion::simulator

// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/truth_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/ply.hpp"
#include "simulator/thing_files.hpp"

namespace pf::simulator {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

Json personJson(const PersonTruth& person) {
  Json joints = Json::array();
  for (std::size_t j = 0; j < person.joints_px.size(); ++j) {
    const auto& p = person.joints_world_m[j];
    const auto& uv = person.joints_px[j];
    joints.push_back({{"world_m", {rounded(p.x(), 1e4), rounded(p.y(), 1e4), rounded(p.z(), 1e4)}},
                      {"pixel", {rounded(uv.x(), 100), rounded(uv.y(), 100)}},
                      {"in_view", person.in_view[j]},
                      {"visible", person.visible[j]}});
  }
  return {{"id", person.id}, {"name", person.name}, {"pixels", person.pixels}, {"joints", joints}};
}

/// The rooms that have names: their places, and which they are like.
Json roomsJson(const Scenario& scenario) {
  Json rooms = Json::array();
  for (const RoomSpec& room : scenario.rooms) {
    if (room.name.empty()) continue;
    const Eigen::Vector2d low = room.origin_m, high = low + room.size_m.head<2>();
    rooms.push_back({{"name", room.name},
                     {"low_m", {rounded(low.x(), 1e4), rounded(low.y(), 1e4)}},
                     {"high_m", {rounded(high.x(), 1e4), rounded(high.y(), 1e4)}}});
    if (!room.like.empty()) rooms.back()["like"] = room.like;
  }
  return rooms;
}

Json visitsJson(const Simulation& simulation, int frames) {
  Json visits = Json::array();
  for (const Visit& visit : simulation.visits(frames)) {
    visits.push_back({{"room", visit.room},
                      {"start", formatStamp(simulation.stampOf(visit.start_s))},
                      {"end", formatStamp(simulation.stampOf(visit.end_s))}});
  }
  return visits;
}

pf::SurfacePoint pointOf(const Eigen::Vector3f& position, const Eigen::Vector3f& normal,
                         const Eigen::Vector3f& color) {
  return {position, normal, {srgbOf(color[0]), srgbOf(color[1]), srgbOf(color[2])}};
}

void putPoint(std::ostream& out, const pf::SurfacePoint& point) {
  std::array<char, kPointBytes> bytes;
  packPoint(point, bytes.data());
  out.write(bytes.data(), bytes.size());
}

/// The surface's colour within a triangle.
Eigen::Vector3f colorAt(const World& world, const Mesh& mesh, std::size_t triangle, float u,
                        float v, float size_m) {
  const auto& t = mesh.triangles[triangle];
  const Material& m = world.materials[mesh.materials[triangle]];
  const Eigen::Vector2f uv = (1 - u - v) * mesh.uv[t[0]] + u * mesh.uv[t[1]] + v * mesh.uv[t[2]];
  const float footprint = size_m / (m.picture_size_m > 0.0F ? m.picture_size_m : 1.0F);
  return world.textures[static_cast<std::size_t>(m.texture)]
      .sample(uv.x(), uv.y(), footprint)
      .cwiseProduct(m.tint);
}

}  // namespace

FrameRecord recordOf(const SimulatedFrame& f) {
  return {f.index,         f.frame.stamp_ns, f.depth_stamp_ns, f.dropped, f.exposure.time_ms,
          f.exposure.gain, f.smear_px,       f.people};
}

void saveJoints(const std::string& path, const std::vector<FrameRecord>& frames) {
  AtomicFile file(path);
  Json names = Json::array();
  for (const auto& name : kJointNames) names.push_back(std::string(name));
  // Frame by frame: the whole of a long recording would not fit as one tree.
  file.stream() << "{\"joints\": " << names.dump() << ",\n\"frames\": [\n";
  bool first = true;
  for (const FrameRecord& frame : frames) {
    if (frame.dropped) continue;
    Json people = Json::array();
    for (const auto& person : frame.people) people.push_back(personJson(person));
    const Json line = {{"stamp", formatStamp(frame.stamp_ns)}, {"people", people}};
    file.stream() << (first ? "" : ",\n") << line.dump();
    first = false;
  }
  file.stream() << "\n]}\n";
  file.commit();
}

void saveEvents(const std::string& path, const Simulation& simulation,
                const std::vector<FrameRecord>& frames) {
  Json events = Json::array();
  for (const Event& e : simulation.events(static_cast<int>(frames.size()))) {
    events.push_back({{"kind", e.kind},
                      {"start", formatStamp(simulation.stampOf(e.start_s))},
                      {"end", formatStamp(simulation.stampOf(e.end_s))}});
  }
  for (const FrameRecord& frame : frames) {
    const std::string stamp = formatStamp(frame.stamp_ns);
    if (frame.dropped) events.push_back({{"kind", "dropped"}, {"start", stamp}, {"end", stamp}});
    if (frame.smear_px > kBlurred_px) {
      events.push_back({{"kind", "blurred"},
                        {"start", stamp},
                        {"end", stamp},
                        {"smear_px", rounded(frame.smear_px, 10)}});
    }
  }
  Json list = Json::array();
  for (const FrameRecord& frame : frames) {
    if (frame.dropped) continue;
    list.push_back({{"stamp", formatStamp(frame.stamp_ns)},
                    {"depth_stamp", formatStamp(frame.depth_stamp_ns)},
                    {"exposure_ms", rounded(frame.exposure_ms, 1e3)},
                    {"gain", rounded(frame.gain, 1e3)},
                    {"smear_px", rounded(frame.smear_px, 100)}});
  }
  Json all = {{"scenario", simulation.scenario().name},
              {"seed", simulation.scenario().seed},
              {"events", events},
              {"frames", list}};
  if (const Json rooms = roomsJson(simulation.scenario()); !rooms.empty()) {
    all["rooms"] = rooms;
    all["visits"] = visitsJson(simulation, static_cast<int>(frames.size()));
  }
  if (!simulation.things().empty()) {
    all["things"] = thingsJson(simulation, static_cast<int>(frames.size()));
  }
  AtomicFile file(path);
  file.stream() << all.dump(1) << "\n";
  file.commit();
}

void saveSceneMesh(const std::string& path, const World& world, const Mesh& mesh) {
  std::vector<Eigen::Vector3f> colors(mesh.positions.size(), Eigen::Vector3f::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const float corner[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    for (std::size_t k = 0; k < 3; ++k) {
      colors[mesh.triangles[t][k]] = colorAt(world, mesh, t, corner[k][0], corner[k][1], 0.02F);
    }
  }
  AtomicFile file(path);
  file.stream() << plyHeader({{"vertex", mesh.positions.size(), pointProperties()},
                              {"face", mesh.triangles.size(), {"list uchar int vertex_indices"}}});
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    putPoint(file.stream(), pointOf(mesh.positions[v], mesh.normals[v], colors[v]));
  }
  for (const auto& t : mesh.triangles) {
    file.stream().put(3);
    file.stream().write(reinterpret_cast<const char*>(t.data()), sizeof t);
  }
  file.commit();
}

void saveScenePoints(const std::string& path, const World& world, const Mesh& mesh,
                     double spacing_m) {
  std::vector<pf::SurfacePoint> points;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const Eigen::Vector3f a = mesh.positions[v[0]], ab = mesh.positions[v[1]] - a,
                          ac = mesh.positions[v[2]] - a;
    const int n =
        std::max(1, static_cast<int>(std::ceil(std::max(ab.norm(), ac.norm()) / spacing_m)));
    for (int i = 0; i < n; ++i) {
      for (int k = 0; i + k < n; ++k) {
        const float u = (i + 0.33F) / n, w = (k + 0.33F) / n;
        points.push_back(pointOf(a + u * ab + w * ac, mesh.normals[v[0]],
                                 colorAt(world, mesh, t, u, w, static_cast<float>(spacing_m))));
      }
    }
  }
  AtomicFile file(path);
  file.stream() << plyHeader({{"vertex", points.size(), pointProperties()}});
  for (const pf::SurfacePoint& p : points) putPoint(file.stream(), p);
  file.commit();
}

}  // namespace pf::simulator

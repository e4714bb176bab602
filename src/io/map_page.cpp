// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/map_page.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>

#include "base64.hpp"
#include "page_parts.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

using nlohmann::ordered_json;
using Writers = std::map<std::string, std::function<void(std::ostream&)>>;

constexpr double kLeastLimit_mb = 0.1, kMostLimit_mb = 500;
constexpr std::size_t kPageBytes = 40'000;  // without the map
constexpr double kStray = 0.005;            // of the vertices, at each end of each axis

std::string escaped(const std::string& text) {
  static const std::map<char, std::string> names = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string out;
  for (const char c : text) {
    const auto name = names.find(c);
    out += name == names.end() ? std::string(1, c) : name->second;
  }
  return out;
}

/// The box of all but the few vertices farthest out, low and high.
std::array<Eigen::Vector3f, 2> boxOf(const PageGeometry& geometry) {
  std::array<Eigen::Vector3f, 2> box;
  std::vector<float> along(geometry.vertices);
  const auto stray = static_cast<std::size_t>(kStray * static_cast<double>(geometry.vertices));
  for (int axis = 0; axis < 3; ++axis) {
    std::size_t i = 0;
    for (const PageChunk& chunk : geometry.chunks) {
      for (const PageVertex& v : chunk.vertices) along[i++] = positionOf(chunk, v)[axis];
    }
    const auto at = [&](std::size_t place) {
      const auto nth = along.begin() + static_cast<std::ptrdiff_t>(place);
      std::nth_element(along.begin(), nth, along.end());
      return *nth;
    };
    box[0][axis] = at(stray);
    box[1][axis] = at(along.size() - 1 - stray);
  }
  return box;
}

ordered_json jsonOf(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

std::string factsOf(const PageGeometry& geometry) {
  const auto [low, high] = boxOf(geometry);
  ordered_json chunks = ordered_json::array();
  for (const PageChunk& chunk : geometry.chunks) {
    chunks.push_back({{"vertices", chunk.vertices.size()},
                      {"triangles", chunk.indices.size() / 3},
                      {"low", jsonOf(chunk.low)},
                      {"side", jsonOf(chunk.side)},
                      {"largest_radius", chunk.largest_radius_m}});
  }
  return ordered_json{{"shows", geometry.triangles > 0 ? "triangles" : "surfels"},
                      {"vertices", geometry.vertices},
                      {"triangles", geometry.triangles},
                      {"step_m", geometry.step_m},
                      {"box", {{"low", jsonOf(low)}, {"high", jsonOf(high)}}},
                      {"chunks", chunks}}
      .dump();
}

void writeChunks(std::ostream& out, const PageGeometry& geometry) {
  for (std::size_t i = 0; i < geometry.chunks.size(); ++i) {
    const PageChunk& chunk = geometry.chunks[i];
    // One text for both: its vertices are a multiple of the three bytes that four characters hold.
    out << "<script id=\"chunk" << i << "\" type=\"application/octet-stream\">";
    static_assert(sizeof(PageVertex) % 3 == 0, "else padding would stand between the two");
    writeBase64(out, chunk.vertices.data(), chunk.vertices.size() * sizeof(PageVertex));
    writeBase64(out, chunk.indices.data(), chunk.indices.size() * sizeof(std::uint16_t));
    out << "</script>\n";
  }
}

/// The template with each {{name}} replaced.
void fill(std::ostream& out, const std::string& text, const Writers& writers) {
  std::size_t at = 0;
  while (true) {
    const std::size_t open = text.find("{{", at);
    const std::size_t close = open == std::string::npos ? open : text.find("}}", open);
    if (close == std::string::npos) break;
    out.write(&text[at], static_cast<std::streamsize>(open - at));
    writers.at(text.substr(open + 2, close - open - 2))(out);
    at = close + 2;
  }
  out << text.substr(at);
}

}  // namespace

void validate(const MapPageConfig& config) {
  validate(config.mesh);
  require(config.size_limit_mb >= kLeastLimit_mb && config.size_limit_mb <= kMostLimit_mb,
          "page: size limit:", config.size_limit_mb, "0.1 to 500 MB");
}

void requirePageName(const std::string& path) { requireEnding(path, {".html"}); }

void writeMapPage(std::ostream& out, const PageGeometry& geometry, const std::string& title) {
  const auto part = [](const char* name) {
    return [name](std::ostream& to) { to << pagePart(name); };
  };
  const Writers writers = {{"title", [&](std::ostream& to) { to << escaped(title); }},
                           {"style", part("page.css")},
                           {"script",
                            [&](std::ostream& to) {
                              for (const char* name : {"camera.js", "scene.js", "page.js"})
                                to << pagePart(name);
                            }},
                           {"facts", [&](std::ostream& to) { to << factsOf(geometry); }},
                           {"chunks", [&](std::ostream& to) { writeChunks(to, geometry); }}};
  fill(out, pagePart("page.html"), writers);
}

PageGeometry saveMapPage(const std::string& path, const SurfelArrays& surfels,
                         const std::string& title, const MapPageConfig& config) {
  requirePageName(path);
  validate(config);
  AtomicFile file(path);  // before the work: it may not be writable
  const auto most_bytes =
      static_cast<std::size_t>((1e6 * config.size_limit_mb - kPageBytes) * 3 / 4);
  const PageGeometry geometry = config.kind == PageKind::mesh
                                    ? pageMesh(surfels, config.mesh, most_bytes)
                                    : pageSurfels(surfels, most_bytes);
  writeMapPage(file.stream(), geometry, title);
  file.commit();
  return geometry;
}

}  // namespace pf

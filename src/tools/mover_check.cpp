// SPDX-License-Identifier: BSD-3-Clause
// For the bench: how soon a map forgets the place that a thing has left, once it is seen empty, and
// has it at its new one, once it is seen there. The whole chain runs over a simulated recording in
// which things move; after each frame the map is asked.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/evaluation/place_watch.hpp"
#include "posefusion/evaluation/thing_check.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/run/run.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr float kSpacing_m = 0.04F;               // of the points that are watched
constexpr float kApart_m = 0.08F;                 // from all else
constexpr std::int64_t kBefore_ns = 500'000'000;  // watching begins before a thing moves
constexpr std::int64_t kSpan_ns = 200'000'000;    // between two looks at the map
constexpr double kMinDepth_m = 0.1, kMaxDepth_m = 20.0;

struct Options {
  std::string sequence, detector;
  std::vector<std::string> settings;
  bool json = false;
};

/// One thing's move, watched at both ends.
struct WatchedMove {
  std::string thing;
  ThingMove move;
  std::int64_t until_ns = INT64_MAX;  ///< when it moves again
  PlaceWatch left, taken;
};

using Points = std::vector<Eigen::Vector3f>;

/// The surface at a place, thinned, without what lies near the other surfaces.
std::vector<Eigen::Vector3d> placeOf(const SurfaceSamples& thing, const Eigen::Isometry3d& pose,
                                     const SurfaceSamples& room,
                                     const std::optional<SurfaceSamples>& beside) {
  Points points;
  for (const Eigen::Vector3f& p : thing.positions) {
    const Eigen::Vector3f at = pose.cast<float>() * p;
    const bool is_near = std::any_of(points.begin(), points.end(), [&](const auto& other) {
      return (other - at).squaredNorm() < kSpacing_m * kSpacing_m;
    });
    if (!is_near) points.push_back(at);
  }
  std::vector<float> apart = distancesToSurface(points, room);
  if (beside) {
    const std::vector<float> other = distancesToSurface(points, *beside);
    for (std::size_t i = 0; i < apart.size(); ++i) apart[i] = std::min(apart[i], other[i]);
  }
  std::vector<Eigen::Vector3d> free;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (apart[i] > kApart_m) free.emplace_back(points[i].cast<double>());
  }
  return free;
}

SurfaceSamples roomOf(const std::string& sequence) {
  SurfaceSamples room;
  for (const SurfacePoint& point : loadPoints(sequence + "/things/room_points.ply")) {
    room.positions.push_back(point.position);
    room.normals.push_back(point.normal);
  }
  return room;
}

std::vector<WatchedMove> watchedMoves(const std::string& sequence) {
  const SurfaceSamples room = roomOf(sequence);
  std::vector<WatchedMove> moves;
  for (const RecordedThing& thing : loadThings(sequence)) {
    const SurfaceSamples surface = surfaceOf(thing);
    for (std::size_t i = 0; i < thing.moves.size(); ++i) {
      const ThingMove& move = thing.moves[i];
      SurfaceSamples after = surface;
      pf::move(move.to, after);
      const bool is_last = i + 1 == thing.moves.size();
      moves.push_back({thing.name,
                       move,
                       is_last ? INT64_MAX : thing.moves[i + 1].begin_ns,
                       {PlaceWatch::Kind::left, placeOf(surface, move.from, room, after)},
                       {PlaceWatch::Kind::taken, placeOf(surface, move.to, room, std::nullopt)}});
    }
  }
  return moves;
}

void watch(const MappedView& view, std::vector<WatchedMove>& moves) {
  for (WatchedMove& watched : moves) {
    if (view.stamp_ns >= watched.until_ns) continue;
    if (view.stamp_ns >= watched.move.begin_ns - kBefore_ns) watched.left.add(view);
    if (view.stamp_ns >= watched.move.end_ns) watched.taken.add(view);
  }
}

/// Runs the chain, with an eye on the moves.
void mapAndWatch(const Options& options, std::vector<WatchedMove>& moves) {
  Config config;
  for (const std::string& setting : options.settings) applyAssignment(config, setting);
  if (!options.detector.empty()) config.pose.detector = options.detector;
  const auto source = openTumFolder(options.sequence);
  const Trajectory truth = source->truth();
  config = configFor(config, *source);
  Pipeline pipeline(config, makePoseDetector(config.pose, source->people()));
  cv::Mat depth_m;
  std::int64_t next_ns = INT64_MIN;
  runPipeline(*source, pipeline, [&](const ProcessedFrame& processed, const std::string& defect) {
    const RgbdFrame& frame = processed.seen.frame;
    const FrameStatus& status = processed.status;
    const auto T_world_camera = poseAt(truth, frame.stamp_ns);
    if (!defect.empty() || !status.located || !T_world_camera || frame.stamp_ns < next_ns) {
      return true;
    }
    next_ns = frame.stamp_ns + kSpan_ns;
    depthInMetres(frame, kMinDepth_m, kMaxDepth_m, depth_m);
    watch({frame.stamp_ns, depth_m, frame.camera, *T_world_camera,
           status.T_map_camera * T_world_camera->inverse(), pipeline.mapper().map()},
          moves);
    return true;
  });
}

nlohmann::ordered_json toJson(const PlaceWatch& place, std::int64_t since_ns) {
  const auto secondsTo = [](const std::optional<std::int64_t>& stamp_ns, std::int64_t from_ns) {
    return stamp_ns ? nlohmann::ordered_json(1e-9 * static_cast<double>(*stamp_ns - from_ns))
                    : nlohmann::ordered_json();
  };
  return {{"known_points", place.known()},
          {"seen_after_s", secondsTo(place.seenAt(), since_ns)},
          {"told_after_s", secondsTo(place.toldAt(), place.seenAt().value_or(since_ns))},
          {"of_it_in_view_s", place.inViewS()},
          {"mapped", place.mapped()}};
}

std::string textOf(const PlaceWatch& place) {
  char text[96];
  if (!place.seenAt()) {
    std::snprintf(text, sizeof text, place.known() == 0 ? "not known" : "not seen");
  } else if (!place.toldAt()) {
    std::snprintf(text, sizeof text, "not, %.0f %% of %zu points mapped (%.1f s)",
                  100 * place.mapped(), place.known(), place.inViewS());
  } else {
    const auto wait_ns = static_cast<double>(*place.toldAt() - *place.seenAt());
    std::snprintf(text, sizeof text, "%.1f s, of it in view %.1f s", 1e-9 * wait_ns,
                  place.inViewS());
  }
  return text;
}

int moverCheck(const Options& options) {
  std::vector<WatchedMove> moves = watchedMoves(options.sequence);
  mapAndWatch(options, moves);
  auto out = nlohmann::ordered_json::array();
  if (!options.json) std::printf("%-14s %10s  %-32s %s\n", "thing", "moved", "forgotten", "mapped");
  for (const WatchedMove& watched : moves) {
    const double begin_s = 1e-9 * static_cast<double>(watched.move.begin_ns);
    out.push_back({{"thing", watched.thing},
                   {"begin", begin_s},
                   {"left", toJson(watched.left, watched.move.begin_ns)},
                   {"taken", toJson(watched.taken, watched.move.end_ns)}});
    if (options.json) continue;
    std::printf("%-14s %10.2f  %-32s %s\n", watched.thing.c_str(), begin_s,
                textOf(watched.left).c_str(), textOf(watched.taken).c_str());
  }
  if (options.json) std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{"How soon a map follows the things that were moved.",
                      "posefusion_mover_check"};
  pf::Options options;
  app.addOption("sequence", options.sequence, "TUM folder with truth and things/")->required();
  app.addOption("--detector", options.detector,
                "as of posefusion_run; default: that of the settings");
  app.addOption("--set", options.settings, "KEY=VALUE: any setting");
  app.addFlag("--json", options.json, "print JSON");
  return pf::runTool(app, argc, argv, [&] { return pf::moverCheck(options); });
}

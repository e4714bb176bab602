// SPDX-License-Identifier: BSD-3-Clause
// For the bench: what a frame costs in a big map. A recording without people is mapped once; then
// twice more among copies of that map, few and many. The copies stand behind and beside the camera,
// as the rest of a building does, so that all three see the same.
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/mapper.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr std::size_t kWarmUp = 30;  // frames before the times count
constexpr int kRooms = 9;            // copies in a row
constexpr float kBetweenRooms_m = 0.5F;

struct Options {
  std::string sequence;
  std::size_t frames = 150, few = 300'000, many = 4'000'000;
  int repeats = 3;
};

/// Maps the frames; returns the times (ms) of tracking and fusion of those that were fused.
std::vector<double> mapFrames(const std::vector<RgbdFrame>& frames, Mapper& mapper) {
  std::vector<double> times_ms;
  FlowTracker flow;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameStatus status = mapper.process({frames[i], cv::Mat(), flow.advance(frames[i])});
    Stopwatch watch;
    mapper.view();
    if (i < kWarmUp || status.outcome != FrameOutcome::fused) continue;
    times_ms.push_back(status.tracking_ms + status.fusion_ms + watch.lapMs());
  }
  return times_ms;
}

/// Stable surfels of a map, as they were when they were new.
SurfelArrays stableOf(const SurfelMap& map) {
  SurfelArrays room;
  map.forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    const auto index = static_cast<std::uint32_t>(i);
    if (map.isStable(s, i)) room.append(s, &index, 1);
  });
  for (auto* counts : {&room.created, &room.seen}) {
    std::fill(counts->begin(), counts->end(), 0);
  }
  return room;
}

float extent(const std::vector<float>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low + kBetweenRooms_m;
}

/// Puts `count` surfels into the map: rooms in rows, the first row behind the camera (z < 0).
void addRooms(const SurfelArrays& room, std::size_t count, Mapper& mapper) {
  const float width = extent(room.x), depth = extent(room.z);
  std::vector<std::uint32_t> indices(room.size());
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(i);
  std::size_t added = 0;
  for (int n = 0; added < count; ++n) {
    SurfelArrays copy;
    copy.append(room, indices.data(), std::min(room.size(), count - added));
    for (float& x : copy.x) x += width * static_cast<float>(n % kRooms - kRooms / 2);
    for (float& z : copy.z) z -= depth * static_cast<float>(n / kRooms + 1);
    const std::size_t taken = mapper.add(copy);
    added += taken;
    if (taken == 0) throw InputError("map.memory_limit_mb: too small for so many surfels");
  }
}

/// One measured mapping among copies of the room.
struct Measured {
  std::vector<double> times_ms;
  std::size_t surfels = 0;  ///< in the end
};

void measure(const std::vector<RgbdFrame>& frames, const SurfelArrays& room, std::size_t count,
             Measured& measured) {
  Mapper mapper{Config{}};
  addRooms(room, count, mapper);
  const auto times_ms = mapFrames(frames, mapper);
  measured.times_ms.insert(measured.times_ms.end(), times_ms.begin(), times_ms.end());
  measured.surfels = mapper.map().size();
}

int bigMap(const Options& options) {
  const auto frames = readFrames(options.sequence, kWarmUp + 1, options.frames);
  Mapper alone{Config{}};
  mapFrames(frames, alone);
  const SurfelArrays room = stableOf(alone.map());
  if (room.size() == 0) throw InputError(options.sequence + ": gives no stable surfels");
  Measured few, many;
  for (int i = 0; i < options.repeats; ++i) {
    measure(frames, room, options.few, few);
    measure(frames, room, options.many, many);
  }
  const double few_ms = statisticsOf(few.times_ms).median;
  const double many_ms = statisticsOf(many.times_ms).median;
  const nlohmann::ordered_json out = {
      {"few", {{"surfels", few.surfels}, {"median_ms", few_ms}, {"frames", few.times_ms.size()}}},
      {"many",
       {{"surfels", many.surfels}, {"median_ms", many_ms}, {"frames", many.times_ms.size()}}},
      {"ratio", many_ms / few_ms}};
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{"Time of tracking and fusion among few and among many surfels out of view.",
                      "posefusion_big_map"};
  pf::Options options;
  app.addOption("sequence", options.sequence, "TUM folder without people")->required();
  app.addOption("--frames", options.frames, "of the recording");
  app.addOption("--few", options.few, "surfels out of view");
  app.addOption("--many", options.many, "surfels out of view");
  app.addOption("--repeats", options.repeats, "measurements of each, in turns")
      ->check(pf::positive());
  return pf::runTool(app, argc, argv, [&] { return pf::bigMap(options); });
}

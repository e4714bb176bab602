// SPDX-License-Identifier: BSD-3-Clause
// For the bench: what a correction costs in a big map. A recording without people is mapped once;
// copies of that map and of its keyframes, in rows and each tracked on from the one before, make a
// building, which is loaded. In the last copy the recording goes on, while loops from the first
// keyframe to the last, each a little off from where the last one led, bend all of it.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "building.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/frame/flow.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "posefusion/slam/loop_thread.hpp"
#include "posefusion/slam/mapper.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr double kOff_m = 0.05;  // more than any loop is off: all loops are worth a correction
constexpr double kFrame_s = 1.0 / 30;

struct Options {
  std::string sequence;
  std::size_t frames = 150, surfels = 10'000'000, keyframes = 5'000;
  int corrections = 10;
};

Config configFor(const Options& options) {
  Config config;
  const double bytes = 2.0 * static_cast<double>(options.surfels) * SurfelArrays::bytesPerSurfel();
  config.map.memory_limit_mb = std::max(config.map.memory_limit_mb, bytes / (1 << 20));
  return config;
}

/// The camera of the recording, whose pose is given once.
class Walk {
 public:
  Walk(const std::vector<RgbdFrame>& frames, const MappedRoom& room, Mapper& mapper)
      : frames_(frames), room_(room), mapper_(mapper) {}

  /// Back and forth through the recording. Returns what mapping took (ms).
  double step() {
    const std::size_t period = 2 * frames_.size() - 2, at = number_ % period;
    const std::size_t index = at < frames_.size() ? at : period - at;
    RgbdFrame frame = frames_[index];
    frame.stamp_ns =
        kSecond_ns * 1'000'000 + static_cast<std::int64_t>(number_++) * kSecond_ns / 30;
    Stopwatch watch;
    status_ = mapper_.process({frame, cv::Mat(), flow_.advance(frame)});
    if (status_.state == TrackingState::lost) tellPlace(index);
    return watch.lapMs();
  }

  bool isTracked() const { return status_.outcome == FrameOutcome::fused; }

 private:
  void tellPlace(std::size_t index) {
    mapper_.takeQuestion();
    LoopAnswer answer;
    answer.asked_for_place = true;
    answer.place.emplace();
    answer.place->doubt = PlaceDoubt::none;
    answer.place->log_odds = 10;
    answer.place->alignment.T_map_camera = room_.poses.at(index).T_world_camera;
    mapper_.take(answer);
  }

  const std::vector<RgbdFrame>& frames_;
  const MappedRoom& room_;
  Mapper& mapper_;
  FlowTracker flow_;
  std::size_t number_ = 0;
  FrameStatus status_;
};

LoopAnswer loopBending(const Mapper& mapper, int turn) {
  const auto& keyframes = mapper.backEnd().graph().keyframes();
  const Keyframe &from = keyframes.front(), &to = keyframes.back();
  LoopConstraint loop{from.id, to.id, from.T_map_camera.inverse() * to.T_map_camera,
                      1e-6 * Matrix6d::Identity()};
  loop.T_from_to.translation().x() += turn % 2 == 0 ? kOff_m : -kOff_m;
  LoopAnswer answer;
  answer.loops.push_back(loop);
  return answer;
}

struct Measured {
  std::vector<double> idle_ms, taken_ms, prepared_s;
  int without = 0;  ///< loops that were refused, or only confirmed what is there
};

/// What has become of the loops so far.
struct LoopsSoFar {
  int version;
  std::size_t refused, loops;

  explicit LoopsSoFar(const BackEnd& back_end)
      : version(back_end.graph().version()), refused(back_end.counts().refused) {
    const auto& all = back_end.graph().constraints();
    loops = static_cast<std::size_t>(std::count_if(
        all.begin(), all.end(), [](const auto& c) { return c.kind == ConstraintKind::loop; }));
  }
  bool operator==(const LoopsSoFar& o) const {
    return version == o.version && refused == o.refused && loops == o.loops;
  }
};

/// Frames at the pace of the camera, as live, until the loop that was reported has been decided on;
/// what corrections are prepared in is beside.
void decide(Walk& walk, Mapper& mapper, LoopThread& loops, Measured& measured) {
  const LoopsSoFar before(mapper.backEnd());
  Stopwatch since;
  double waited_s = 0;
  while (LoopsSoFar(mapper.backEnd()) == before) {
    if (waited_s > 60) throw InputError("a loop was not decided on within a minute");
    const double mapping_ms = walk.step();
    mapper.takeQuestion();
    Stopwatch watch;
    loops.serve(mapper);
    const double ms = watch.lapMs();
    waited_s += 1e-3 * since.lapMs();
    if (mapper.backEnd().graph().version() != before.version) {
      measured.taken_ms.push_back(ms);
      measured.prepared_s.push_back(waited_s);
      return;
    }
    measured.idle_ms.push_back(ms);
    std::this_thread::sleep_for(std::chrono::duration<double>(kFrame_s - 1e-3 * (mapping_ms + ms)));
  }
  ++measured.without;
}

Measured correct(Walk& walk, Mapper& mapper, const Options& options, const Config& config) {
  LoopThread loops(config, AnswerTime::when_ready);
  Measured measured;
  for (int turn = 0; static_cast<int>(measured.taken_ms.size()) < options.corrections; ++turn) {
    if (measured.without > 2 * options.corrections) throw InputError("most loops correct nothing");
    mapper.take(loopBending(mapper, turn));
    decide(walk, mapper, loops, measured);
    for (int i = 0; i < 30; ++i) walk.step();
  }
  loops.finish(mapper);
  return measured;
}

int bigCorrection(const Options& options) {
  const Config config = configFor(options);
  const auto frames = readFrames(options.sequence, 60, options.frames);
  const MappedRoom room = mapRoom(frames, config);
  Mapper mapper(config);
  mapper.load(buildingOf(room, options.surfels, options.keyframes), MapUse::extend);
  Walk walk(frames, room, mapper);
  for (int i = 0; i < 60; ++i) walk.step();
  if (!walk.isTracked()) throw InputError("the camera was not found in the building");
  const std::size_t surfels = mapper.map().size();
  const std::size_t keyframes = mapper.backEnd().graph().keyframes().size();
  const Measured measured = correct(walk, mapper, options, config);
  const ErrorStatistics taken = statisticsOf(measured.taken_ms),
                        idle = statisticsOf(measured.idle_ms);
  const nlohmann::ordered_json out = {
      {"surfels", surfels},
      {"keyframes", keyframes},
      {"corrections", measured.taken_ms.size()},
      {"loops_without_correction", measured.without},
      {"on_the_tracking_thread_ms", {{"median", taken.median}, {"most", taken.max}}},
      {"while_one_is_prepared_ms", {{"median", idle.median}, {"most", idle.max}}},
      {"until_taken_in_s",
       {{"median", statisticsOf(measured.prepared_s).median},
        {"most", statisticsOf(measured.prepared_s).max}}}};
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{"Time of a correction in a big map, on the tracking thread and beside it.",
                      "posefusion_big_correction"};
  pf::Options options;
  app.addOption("sequence", options.sequence, "TUM folder without people")->required();
  app.addOption("--frames", options.frames, "of the recording");
  app.addOption("--surfels", options.surfels, "of the map, about");
  app.addOption("--keyframes", options.keyframes, "of the map, about");
  app.addOption("--corrections", options.corrections, "of all of it")->check(pf::positive());
  return pf::runTool(app, argc, argv, [&] { return pf::bigCorrection(options); });
}

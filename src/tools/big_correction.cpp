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

constexpr int kRooms = 9;  // copies in a row
constexpr double kBetweenRooms_m = 0.5;
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

/// A map of one room, and the poses of all its frames.
struct Room {
  SavedMap saved;
  SurfelArrays stable;
  Trajectory poses;
  Eigen::Vector3d size_m;
};

Room mapped(const std::vector<RgbdFrame>& frames, const Config& config) {
  Mapper mapper(config);
  FlowTracker flow;
  for (const RgbdFrame& frame : frames) {
    mapper.process({frame, cv::Mat(), flow.advance(frame)});
    mapper.takeQuestion();
  }
  Room room;
  room.saved = mapper.saved(frames.back().camera);
  room.poses = mapper.backEnd().trajectory();
  Eigen::AlignedBox3f bounds;
  mapper.map().forEachSurfel([&](const SurfelArrays& s, std::size_t i) {
    const auto index = static_cast<std::uint32_t>(i);
    if (!mapper.map().isStable(s, i)) return;
    room.stable.append(s, &index, 1);
    bounds.extend(Eigen::Vector3f(s.x[i], s.y[i], s.z[i]));
  });
  if (room.stable.size() == 0) throw InputError("the recording gives no stable surfels");
  room.size_m = bounds.sizes().cast<double>().array() + kBetweenRooms_m;
  return room;
}

/// Where copy `number` of `count` stands; the last stands where the room is.
Eigen::Vector3d placeOf(int number, int count, const Eigen::Vector3d& size_m) {
  const int from_last = count - 1 - number;
  return {size_m.x() * (from_last % kRooms), 0, -size_m.z() * (from_last / kRooms)};
}

void addSurfels(const Room& room, const Eigen::Vector3d& at, int first_frame, SurfelArrays& all) {
  const std::size_t begin = all.size();
  all.append(room.stable);
  for (std::size_t i = begin; i < all.size(); ++i) {
    all.x[i] += static_cast<float>(at.x());
    all.z[i] += static_cast<float>(at.z());
    all.created[i] += first_frame;
    all.seen[i] += first_frame;
  }
}

void addKeyframes(const Room& room, const Eigen::Vector3d& at, int first_frame, std::size_t count,
                  SavedMap& map) {
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t frame = k * room.poses.size() / count;
    Keyframe keyframe;
    keyframe.id = static_cast<int>(map.keyframes.size());
    keyframe.map_frame = first_frame + static_cast<std::int32_t>(frame);
    keyframe.stamp_ns = static_cast<std::int64_t>(keyframe.map_frame) * kSecond_ns / 30;
    keyframe.T_map_camera = Eigen::Translation3d(at) * room.poses[frame].T_world_camera;
    map.keyframes.push_back(keyframe);
    if (keyframe.id == 0) continue;
    PoseConstraint step;
    step.kind = ConstraintKind::odometry;
    step.from = keyframe.id - 1;
    step.to = keyframe.id;
    const Keyframe& before = map.keyframes[map.keyframes.size() - 2];
    step.T_from_to = before.T_map_camera.inverse() * keyframe.T_map_camera;
    step.covariance = 4e-4 * Matrix6d::Identity();
    map.constraints.push_back(step);
  }
}

SavedMap buildingOf(const Room& room, const Options& options) {
  SavedMap map = room.saved;
  map.keyframes.clear();
  map.constraints.clear();
  map.frames.clear();
  map.views.clear();
  const auto copies =
      static_cast<int>(std::max<std::size_t>(1, options.surfels / room.stable.size()));
  SurfelArrays all;
  for (int n = 0; n < copies; ++n) {
    const Eigen::Vector3d at = placeOf(n, copies, room.size_m);
    const int first_frame = n * (room.saved.frame + 1);
    addSurfels(room, at, first_frame, all);
    addKeyframes(room, at, first_frame, options.keyframes / static_cast<std::size_t>(copies), map);
  }
  map.surfels = {{kFirstFragment, std::move(all)}};
  map.frame = copies * (room.saved.frame + 1) - 1;
  return map;
}

/// The camera of the recording, whose pose is given once.
class Walk {
 public:
  Walk(const std::vector<RgbdFrame>& frames, const Room& room, Mapper& mapper)
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
  const Room& room_;
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
};

/// Frames at the pace of the camera, as live; what corrections are prepared in is beside.
Measured correct(Walk& walk, Mapper& mapper, const Options& options, const Config& config) {
  LoopThread loops(config, AnswerTime::when_ready);
  Measured measured;
  for (int turn = 0; turn < options.corrections; ++turn) {
    mapper.take(loopBending(mapper, turn));
    const int version = mapper.backEnd().graph().version();
    Stopwatch since;
    double waited_s = 0;
    while (mapper.backEnd().graph().version() == version) {
      const double mapping_ms = walk.step();
      mapper.takeQuestion();
      Stopwatch watch;
      loops.serve(mapper);
      const double ms = watch.lapMs();
      const bool is_taken = mapper.backEnd().graph().version() != version;
      (is_taken ? measured.taken_ms : measured.idle_ms).push_back(ms);
      const std::chrono::duration<double> rest(kFrame_s - 1e-3 * (mapping_ms + ms));
      if (!is_taken) std::this_thread::sleep_for(rest);
      waited_s += 1e-3 * since.lapMs();
      if (waited_s > 60) throw InputError("a correction was not accepted within a minute");
    }
    measured.prepared_s.push_back(waited_s);
    for (int i = 0; i < 30; ++i) walk.step();
  }
  loops.finish(mapper);
  return measured;
}

int bigCorrection(const Options& options) {
  const Config config = configFor(options);
  const auto frames = readFrames(options.sequence, 60, options.frames);
  const Room room = mapped(frames, config);
  Mapper mapper(config);
  mapper.load(buildingOf(room, options), MapUse::extend);
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

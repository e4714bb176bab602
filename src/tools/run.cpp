// SPDX-License-Identifier: BSD-3-Clause
// The offline runner: one recorded sequence in, one folder of results out.
#include <tbb/global_control.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "posefusion/core/error.hpp"
#include "posefusion/io/calibrated_source.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/run.hpp"
#include "posefusion/run/run_report.hpp"
#include "progress.hpp"
#include "run_map.hpp"
#include "run_observers.hpp"
#include "run_options.hpp"

namespace pf {
namespace {

constexpr char kJournal[] = "trajectory.partial.txt";  // while the run lasts

volatile std::sig_atomic_t stop_requested = 0;  // the signal that came

/// The first Ctrl-C ends the run in order; the second one ends the process.
void stopOnSignals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { stop_requested = signal; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void requireOtherFolder(const RunOptions& options) {
  std::error_code ignored;
  if (std::filesystem::equivalent(options.input, options.output, ignored)) {
    throw InputError("--output " + options.output + ": is the input, expected another folder");
  }
}

Trajectory truthFor(const RunOptions& options, FrameSource& source) {
  return options.truth.empty() ? source.truth() : loadTrajectory(options.truth);
}

std::unique_ptr<PoseDetector> detectorFor(const RunOptions& options, FrameSource& source) {
  const PoseConfig& config = options.config.pose;
  if (config.detector != "recorded") return makePoseDetector(config, {});
  RecordedPeople people = source.people();
  if (people.empty()) {
    throw InputError("--detector recorded: " + options.input +
                     " has no recorded people, expected people.json or a topic of them");
  }
  return makePoseDetector(config, std::move(people));
}

void sayLeftOut(const InputReport& report, Progress& progress) {
  const auto say = [&](std::size_t count, const std::string& what) {
    if (count > 0) progress.say(std::to_string(count) + " " + what);
  };
  say(report.color_without_depth, "colour images have no depth image near in time: left out");
  say(report.depth_without_color, "depth images have no colour image near in time: left out");
  for (const auto& note : report.notes) progress.say(note);
}

/// Runs the chain; what stops it early (a damaged file) is returned, to be thrown once all is
/// written.
std::exception_ptr process(const RunOptions& options, FrameSource& source, Pipeline& pipeline,
                           RunReport& report, TrajectoryJournal& journal, RunMap& map) {
  RunObservers observers(options, pipeline.mapper().map());
  const std::size_t limit = options.max_frames > 0 ? options.max_frames : SIZE_MAX;
  Progress progress(std::min(source.frameCount(), limit));
  const Eigen::Isometry3d T_world_map = pipeline.mapper().worldFromMap();
  std::exception_ptr failure;
  bool full = false, disk_full = false;
  try {
    runPipeline(source, pipeline, [&](const ProcessedFrame& frame, const std::string& defect) {
      report.add(frame);
      observers.add(frame);
      if (frame.status.located &&
          !journal.add({frame.status.stamp_ns, T_world_map * frame.status.T_map_camera}) &&
          !std::exchange(disk_full, true)) {
        progress.say(std::string(kJournal) + " cannot be written (disk full?): the run goes on");
      }
      const std::string trouble = map.add(frame);
      if (!trouble.empty()) progress.say(trouble + "; tried again");
      if (!defect.empty()) {
        progress.say("frame left out: " + defect);
      } else if (frame.status.outcome == FrameOutcome::bad_input) {
        progress.say("frame left out: " + frame.status.detail);
      }
      if (frame.status.map_full && !std::exchange(full, true)) {
        progress.say(
            "the map is full (map.memory_limit_mb): tracking goes on, without new surfels");
      }
      progress.update(report.statistics().frames().read);
      return stop_requested == 0 && report.statistics().frames().read < limit;
    });
  } catch (...) {
    failure = std::current_exception();
  }
  pipeline.finish();
  observers.finish(report);
  sayLeftOut(source.report(), progress);
  return failure;
}

int run(const RunOptions& options) {
  std::optional<tbb::global_control> limit;
  if (options.threads > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
    cv::setNumThreads(options.threads);
  }
  const auto source =
      calibrated(posefusion_ros::openInput(options.input, options.reading), options.calibration);
  RunReport report(options.config);
  report.setTruth(truthFor(options, *source));
  Pipeline pipeline(options.config, detectorFor(options, *source));
  requireOtherFolder(options);
  if (!options.map_file.empty()) loadMap(options, pipeline);
  makeFolder(options.output);
  stopOnSignals();
  TrajectoryJournal journal(options.output + "/" + kJournal, "the run is not finished");
  RunMap map(options, pipeline.mapper());
  const auto failure = process(options, *source, pipeline, report, journal, map);
  report.setBackEnd(pipeline.mapper().backEnd(), pipeline.loopCounts());
  report.setVerification(pipeline.loopVerificationMs());
  report.write(options.output, pipeline.mapper().map(), pipeline.mapper().worldFromMap());
  journal.remove();
  map.finish();
  const int signal = stop_requested;
  if (signal != 0) std::cout << "interrupted: these are the results so far\n";
  std::cout << report.table() << "results  " << options.output << "\n";
  if (failure) std::rethrow_exception(failure);
  return signal != 0 ? 128 + signal : 0;  // as shells say it
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) { return pf::runWithOptions(argc, argv, pf::run); }

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
#include "posefusion/io/robot_files.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion/run/run.hpp"
#include "posefusion/run/run_report.hpp"
#include "progress.hpp"
#include "run_map.hpp"
#include "run_options.hpp"
#include "run_results.hpp"

namespace pf {
namespace {

volatile std::sig_atomic_t stop_requested = 0;  // the signal that came

/// The first Ctrl-C ends the run in order, as the end of its terminal does; the second one ends the
/// process. What is ignored (nohup) stays ignored.
void stopOnSignals() {
  struct sigaction action {};
  action.sa_handler = [](int signal) { stop_requested = signal; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
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

RobotRecording robotFor(const RunOptions& options) {
  RobotRecording recording;
  if (!options.odometry.empty()) recording.odometry = loadOdometry(options.odometry);
  if (!options.imu.empty()) recording.imu = loadImu(options.imu);
  return recording;
}

/// What the user should know of a frame; empty: nothing.
std::string remarkOn(const ProcessedFrame& frame, const std::string& defect) {
  if (!defect.empty()) return "frame left out: " + defect;
  if (frame.status.outcome != FrameOutcome::bad_input) return {};
  return "frame left out: " + frame.status.detail;
}

/// Runs the chain; what stops it early (a damaged file) is returned, to be thrown once all is
/// written.
std::exception_ptr process(const RunOptions& options, FrameSource& source, Pipeline& pipeline,
                           RunReport& report, RunResults& results) {
  const std::size_t limit = options.max_frames > 0 ? options.max_frames : SIZE_MAX;
  Progress progress(std::min(source.frameCount(), limit));
  const auto say = [&](const std::string& line) {
    if (!line.empty()) progress.say(line);
  };
  std::exception_ptr failure;
  bool full = false;
  int depth_version = pipeline.mapper().depthVersion();
  try {
    runPipeline(source, pipeline, [&](const ProcessedFrame& frame, const std::string& defect) {
      report.add(frame);
      say(results.add(frame));
      say(remarkOn(frame, defect));
      const Mapper& mapper = pipeline.mapper();
      if (std::exchange(depth_version, mapper.depthVersion()) != mapper.depthVersion()) {
        say("learned: " + mapper.lastCalibration());
      }
      if (frame.status.map_full && !std::exchange(full, true)) {
        say("the map is full (map.memory_limit_mb): tracking goes on, without new surfels");
      }
      progress.update(report.statistics().frames().read);
      return stop_requested == 0 && report.statistics().frames().read < limit;
    });
  } catch (...) {
    failure = std::current_exception();
  }
  say(pipeline.finish());
  sayLeftOut(source.report(), progress);
  return failure;
}

/// Throws where the run has no pose of the camera.
void requirePoses(const RunOptions& options, const RunReport& report) {
  if (!report.trajectory().empty()) return;
  const FrameCounts& frames = report.statistics().frames();
  std::string text =
      options.input + ": no frame has a pose: " + std::to_string(frames.read) + " read";
  for (const auto& [outcome, count] : frames.by_outcome) {
    text += ", " + std::to_string(count) + " " + outcome;
  }
  throw InputError(text);
}

int run(const RunOptions& given) {
  RunOptions options = given;
  std::optional<tbb::global_control> limit;
  if (options.threads > 0) {
    limit.emplace(tbb::global_control::max_allowed_parallelism, options.threads);
    cv::setNumThreads(options.threads);
  }
  const auto source = posefusion_ros::openInput(options.input, options.reading);
  options.config = configFor(options.config, *source);
  RunReport report(options.config);
  report.setTruth(truthFor(options, *source));
  Pipeline pipeline(options.config, detectorFor(options, *source));
  requireOtherFolder(options);
  pipeline.accompany(robotFor(options));
  if (!options.calibration.empty()) useCalibration(options, pipeline);
  if (!options.map_file.empty()) loadMap(options, pipeline);
  stopOnSignals();
  RunResults results(options, pipeline);
  const auto failure = process(options, *source, pipeline, report, results);
  report.setColor(pipeline.colorEstimate());
  report.setBackEnd(pipeline.mapper().backEnd(), pipeline.loopCounts());
  report.setVerification(pipeline.loopVerificationMs());
  results.finish(report);
  const int signal = stop_requested;
  if (signal != 0) std::cout << "interrupted: these are the results so far\n";
  std::cout << report.table() << "results  " << results.path() << "\n";
  if (failure) std::rethrow_exception(failure);
  if (signal != 0) return 128 + signal;  // as shells say it
  requirePoses(options, report);
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) { return pf::runWithOptions(argc, argv, pf::run); }

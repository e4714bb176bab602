// SPDX-License-Identifier: BSD-3-Clause
// posefusion_measure_detector: how many simulated people a detector finds, and how long it takes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/pose/detector.hpp"
#include "progress.hpp"
#include "simulator/contact_sheet.hpp"
#include "simulator/scenario.hpp"
#include "simulator/simulation.hpp"
#include "tool.hpp"

namespace {

using namespace pf;
using namespace pf::simulator;

constexpr int kFewestJoints = 4;

struct Count {
  int people = 0, found = 0, empty_frames = 0, empty_with_people = 0;
  std::vector<double> times_ms;  ///< of the detector, frame by frame

  void add(const Count& more) {
    people += more.people, found += more.found;
    empty_frames += more.empty_frames, empty_with_people += more.empty_with_people;
    times_ms.insert(times_ms.end(), more.times_ms.begin(), more.times_ms.end());
  }
};

bool has(const std::array<bool, kJointCount>& flags, Joint joint) {
  return flags[static_cast<std::size_t>(joint)];
}

/// Head and torso can be seen, 1 to 4 m away.
bool wellInView(const PersonTruth& p, const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Vector3d neck =
      T_world_camera.inverse() * p.joints_world_m[static_cast<std::size_t>(Joint::neck)];
  if (neck.z() < 1.0 || neck.z() > 4.0) return false;
  for (const Joint j : {Joint::right_shoulder, Joint::left_shoulder, Joint::right_hip,
                        Joint::left_hip, Joint::nose}) {
    if (!has(p.in_view, j)) return false;
  }
  const bool head = has(p.visible, Joint::nose) || has(p.visible, Joint::right_ear) ||
                    has(p.visible, Joint::left_ear);
  const bool hips = has(p.visible, Joint::right_hip) || has(p.visible, Joint::left_hip);
  const bool shoulders =
      has(p.visible, Joint::right_shoulder) || has(p.visible, Joint::left_shoulder);
  return head && hips && shoulders;
}

bool isFound(const PersonTruth& truth, const cv::Mat& mask, const People& detected) {
  for (const Person& person : detected.people) {
    int inside = 0;
    for (const Keypoint& k : person.joints) {
      const int col = static_cast<int>(std::lround(k.u)), row = static_cast<int>(std::lround(k.v));
      const bool in = k.p > 0.0F && col >= 0 && row >= 0 && col < mask.cols && row < mask.rows;
      if (in && mask.at<std::uint8_t>(row, col) == truth.id) ++inside;
    }
    if (inside >= kFewestJoints) return true;
  }
  return false;
}

/// Counts one frame; the answer is whether something went wrong in it.
bool judge(const SimulatedFrame& frame, const People& detected, Count& count) {
  if (cv::countNonZero(frame.mask) == 0) {
    ++count.empty_frames;
    count.empty_with_people += detected.people.empty() ? 0 : 1;
    return !detected.people.empty();
  }
  bool missed = false;
  for (const PersonTruth& truth : frame.people) {
    if (!wellInView(truth, frame.T_world_camera)) continue;
    const bool found = isFound(truth, frame.mask, detected);
    ++count.people;
    count.found += found ? 1 : 0;
    missed |= !found;
  }
  return missed;
}

/// What is asked.
struct Options {
  std::vector<std::string> scenarios;
  std::string failures_file;
  int every = 15;
  ScenarioChanges changes;
  PoseConfig config;
};

/// Goes through one scenario; frames that went wrong are added to `failures`.
Count measure(const std::string& name, const Options& options, PoseDetector& detector,
              cv::Mat& failures) {
  Simulation simulation(loadScenario(name, options.changes));
  Count count;
  Progress progress(static_cast<std::size_t>(simulation.frameCount()));
  for (int i = 0; i < simulation.frameCount(); i += options.every) {
    simulation.jump();
    const SimulatedFrame frame = simulation.frame(i);
    if (frame.dropped) continue;
    Stopwatch watch;
    const People people = detector.detect(frame.frame);
    count.times_ms.push_back(watch.lapMs());
    const bool wrong = judge(frame, people, count);
    if (wrong && failures.rows < 12 * 300) failures.push_back(drawFrame(frame, simulation, 400));
    progress.update(static_cast<std::size_t>(i + 1));
  }
  return count;
}

double percent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0.0; }

void print(const std::string& name, const Count& c) {
  std::printf("%-20s found %d of %d people (%.1f %%), people in %d of %d empty frames (%.1f %%)\n",
              name.c_str(), c.found, c.people, percent(c.found, c.people), c.empty_with_people,
              c.empty_frames, percent(c.empty_with_people, c.empty_frames));
}

void printTime(std::vector<double> times_ms) {
  if (times_ms.empty()) return;
  const auto middle = times_ms.begin() + static_cast<std::ptrdiff_t>(times_ms.size() / 2);
  std::nth_element(times_ms.begin(), middle, times_ms.end());
  std::printf("a frame takes the detector %.2f ms in the median of %zu\n", *middle,
              times_ms.size());
}

void measureAll(const Options& options) {
  const auto detector = makePoseDetector(options.config, {});
  Count total;
  cv::Mat failures;
  for (const auto& name : options.scenarios) {
    const Count c = measure(name, options, *detector, failures);
    print(name, c);
    total.add(c);
  }
  printTime(std::move(total.times_ms));
  print("all", total);
  if (!options.failures_file.empty() && !failures.empty()) {
    savePng(options.failures_file, failures);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{
      "Counts the simulated people with head and torso in view, 1 to 4 m away, of which a\n"
      "detector finds 4 joints or more, the empty frames in which it finds a person, and its\n"
      "time a frame.",
      "posefusion_measure_detector"};
  Options o;
  o.config.every_nth_frame = 1;
  app.addOption("scenarios", o.scenarios, "names or scene files")->required();
  app.addOption("--detector", o.config.detector, "as in the settings")
      ->check(oneOf({"auto", "embedded", "network", "network+embedded"}));
  app.addOption("--model", o.config.model, "weights of a pose network");
  app.addOption("--embedded-model", o.config.embedded_model, "weights of a person model");
  app.addOption("--every", o.every, "looks at every n-th frame")->check(range(1, 10000));
  app.addOption("--duration", o.changes.duration_s, "seconds")->check(positive());
  app.addOption("--seed", o.changes.seed, "of the simulation");
  app.addOption("--set", o.changes.assignments, "KEY=VALUE: any value of the scene file");
  app.addOption("--failures", o.failures_file, "PNG with the first frames that went wrong");
  return runTool(app, argc, argv, [&] {
    measureAll(o);
    return 0;
  });
}

// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include "posefusion/core/stamps.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/tum_writer.hpp"
#include "simulator/depth_distortion.hpp"
#include "simulator/output.hpp"
#include "simulator/sense_files.hpp"
#include "simulator/thing_files.hpp"
#include "simulator/truth.hpp"
#include "simulator/truth_files.hpp"

namespace pf::simulator {
namespace {

namespace fs = std::filesystem;

constexpr double kSpacing_m = 0.03;  // of scene_points.ply

class TumOutput : public Output {
 public:
  TumOutput(const std::string& folder, const Simulation& simulation)
      : folder_(folder), writer_(folder, simulation.scenario().camera, 1000.0) {
    for (const char* part : {"mask", "person_mask"}) makeFolder(folder_ / part);
    if (!simulation.things().empty()) makeFolder(folder_ / "thing_mask");
    const Scenario& scenario = simulation.scenario();
    saveCalibration(
        folder_ / "depth_field.yaml",
        {"specimen " + std::to_string(scenario.depth.specimen), scenario.camera,
         trueField(scenario.depth, scenario.camera, scenario.start_s + 0.5 * scenario.duration_s)});
  }

  void add(const SimulatedFrame& frame) override {
    records_.push_back(recordOf(frame));
    if (frame.dropped) return;
    writer_.add(frame.frame, frame.depth_stamp_ns);
    writer_.addMask(frame.frame.stamp_ns, frame.mask > 0);
    writer_.addPeople(asDetected(frame));
    const std::string file = formatStamp(frame.frame.stamp_ns) + ".png";
    savePng(folder_ / "person_mask" / file, frame.mask);
    if (!frame.thing_mask.empty()) savePng(folder_ / "thing_mask" / file, frame.thing_mask);
  }

  void finish(const Simulation& simulation) override {
    const int frames = static_cast<int>(records_.size());
    for (const auto& pose : simulation.truth(frames)) writer_.addTruth(pose);
    writer_.finish();
    saveJoints(folder_ / "joints.json", records_);
    saveEvents(folder_ / "events.json", simulation, records_);
    saveSenses(folder_, simulation, frames);
    const Mesh scene = simulation.sceneAfter(frames);
    saveSceneMesh(folder_ / "scene.ply", simulation.world(), scene);
    saveScenePoints(folder_ / "scene_points.ply", simulation.world(), scene, kSpacing_m);
    if (!simulation.things().empty()) saveThings(folder_, simulation, frames);
  }

 private:
  fs::path folder_;
  TumWriter writer_;
  std::vector<FrameRecord> records_;
};

}  // namespace

std::unique_ptr<Output> openTumOutput(const std::string& folder, const Simulation& simulation) {
  return std::make_unique<TumOutput>(folder, simulation);
}

}  // namespace pf::simulator

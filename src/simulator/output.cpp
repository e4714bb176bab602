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
#include "simulator/truth.hpp"
#include "simulator/truth_files.hpp"

namespace pf::simulator {
namespace {

namespace fs = std::filesystem;

class TumOutput : public Output {
 public:
  TumOutput(const std::string& folder, const Simulation& simulation)
      : folder_(folder), writer_(folder, simulation.scenario().camera, 1000.0) {
    for (const char* part : {"mask", "person_mask"}) makeFolder(folder_ / part);
    saveSceneMesh(folder_ / "scene.ply", simulation.world());
    const Scenario& scenario = simulation.scenario();
    saveCalibration(
        folder_ / "depth_field.yaml",
        {"specimen " + std::to_string(scenario.depth.specimen), scenario.camera,
         trueField(scenario.depth, scenario.camera, scenario.start_s + 0.5 * scenario.duration_s)});
    saveScenePoints(folder_ / "scene_points.ply", simulation.world(), 0.03);
  }

  void add(const SimulatedFrame& frame) override {
    records_.push_back(recordOf(frame));
    if (frame.dropped) return;
    writer_.add(frame.frame, frame.depth_stamp_ns);
    writer_.addMask(frame.frame.stamp_ns, frame.mask > 0);
    writer_.addPeople(asDetected(frame));
    savePng(folder_ / "person_mask" / (formatStamp(frame.frame.stamp_ns) + ".png"), frame.mask);
  }

  void finish(const Simulation& simulation) override {
    for (const auto& pose : simulation.truth(static_cast<int>(records_.size()))) {
      writer_.addTruth(pose);
    }
    writer_.finish();
    saveJoints(folder_ / "joints.json", records_);
    saveEvents(folder_ / "events.json", simulation, records_);
    saveSenses(folder_, simulation, static_cast<int>(records_.size()));
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

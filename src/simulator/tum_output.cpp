// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/camera_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/people_json.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "simulator/output.hpp"
#include "simulator/truth.hpp"
#include "simulator/truth_files.hpp"

namespace pf::simulator {
namespace {

namespace fs = std::filesystem;

class TumOutput : public Output {
 public:
  TumOutput(const std::string& folder, const Simulation& simulation) : folder_(folder) {
    if (fs::exists(folder_) && (!fs::is_directory(folder_) || !fs::is_empty(folder_))) {
      throw InputError(folder + ": is there and not empty, expected a new folder");
    }
    for (const char* part : {"rgb", "depth", "mask", "person_mask"}) makeFolder(folder_ / part);
    saveCamera(folder_ / "camera.yaml", {simulation.scenario().camera, 1000.0});
    saveSceneMesh(folder_ / "scene.ply", simulation.world());
    saveScenePoints(folder_ / "scene_points.ply", simulation.world(), 0.03);
  }

  void add(const SimulatedFrame& frame) override {
    records_.push_back(recordOf(frame));
    if (frame.dropped) return;
    const std::string color = formatStamp(frame.frame.stamp_ns) + ".png";
    savePng(folder_ / "rgb" / color, frame.frame.color);
    savePng(folder_ / "depth" / (formatStamp(frame.depth_stamp_ns) + ".png"), frame.frame.depth);
    savePng(folder_ / "mask" / color, frame.mask > 0);
    savePng(folder_ / "person_mask" / color, frame.mask);
    people_.push_back(asDetected(frame));
  }

  void finish(const Simulation& simulation) override {
    const auto list = [&](const char* name, const char* columns, const auto& line) {
      AtomicFile out(folder_ / name);
      out.stream() << "# " << columns << "\n";
      for (const auto& record : records_) {
        if (!record.dropped) {
          out.stream() << line(formatStamp(record.stamp_ns), formatStamp(record.depth_stamp_ns))
                       << "\n";
        }
      }
      out.commit();
    };
    using Text = const std::string&;
    list("rgb.txt", "timestamp filename", [](Text c, Text) { return c + " rgb/" + c + ".png"; });
    list("depth.txt", "timestamp filename",
         [](Text, Text d) { return d + " depth/" + d + ".png"; });
    list("associations.txt", "timestamp filename timestamp filename",
         [](Text c, Text d) { return c + " rgb/" + c + ".png " + d + " depth/" + d + ".png"; });
    saveTrajectory(folder_ / "groundtruth.txt", simulation.truth(static_cast<int>(records_.size())),
                   "camera to world");
    savePeople(folder_ / "people.json", people_);
    saveJoints(folder_ / "joints.json", records_);
    saveEvents(folder_ / "events.json", simulation, records_);
  }

 private:
  fs::path folder_;
  std::vector<FrameRecord> records_;
  std::vector<People> people_;
};

}  // namespace

std::unique_ptr<Output> openTumOutput(const std::string& folder, const Simulation& simulation) {
  return std::make_unique<TumOutput>(folder, simulation);
}

}  // namespace pf::simulator

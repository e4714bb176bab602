// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/tum_writer.hpp"

#include <cmath>
#include <filesystem>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/camera_file.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/people_json.hpp"
#include "posefusion/io/trajectory_file.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

/// Depth as 16 bit; what does not fit (too far, invalid) is 0.
cv::Mat packDepth(const RgbdFrame& frame, double depth_factor) {
  if (frame.depth.type() == CV_16UC1 && std::abs(frame.depth_unit_m * depth_factor - 1.0) < 1e-9) {
    return frame.depth;
  }
  cv::Mat metres;
  depthInMetres(frame, 1e-4, 1e4, metres);
  cv::Mat packed(metres.size(), CV_16UC1);
  for (int v = 0; v < packed.rows; ++v) {
    for (int u = 0; u < packed.cols; ++u) {
      const double steps = std::round(metres.at<float>(v, u) * depth_factor);
      packed.at<std::uint16_t>(v, u) = steps <= 65535.0 ? static_cast<std::uint16_t>(steps) : 0;
    }
  }
  return packed;
}

}  // namespace

struct TumWriter::State {
  fs::path folder;
  CameraFile camera;
  struct Pair {
    std::string color, depth;  ///< stamps
  };
  std::vector<Pair> pairs;
  Trajectory truth;
  std::vector<People> people;
};

TumWriter::TumWriter(const std::string& folder, const PinholeCamera& camera, double depth_factor)
    : state_(std::make_unique<State>()) {
  validate(camera);
  if (fs::exists(folder) && (!fs::is_directory(folder) || !fs::is_empty(folder))) {
    throw InputError(folder + ": is there and not empty, expected a new folder");
  }
  state_->folder = folder;
  state_->camera = {camera, depth_factor};
  for (const char* part : {"rgb", "depth"}) makeFolder(state_->folder / part);
  saveCamera(state_->folder / "camera.yaml", state_->camera);
}

TumWriter::~TumWriter() = default;

void TumWriter::add(const RgbdFrame& frame) { add(frame, frame.stamp_ns); }

void TumWriter::add(const RgbdFrame& frame, std::int64_t depth_stamp_ns) {
  const std::string defect = defectOf(frame);
  if (!defect.empty()) throw InputError(state_->folder.string() + ": " + defect);
  if (frame.camera != state_->camera.camera) {
    throw InputError(state_->folder.string() + ": a frame of another camera cannot be added");
  }
  const State::Pair stamps{formatStamp(frame.stamp_ns), formatStamp(depth_stamp_ns)};
  savePng(state_->folder / "rgb" / (stamps.color + ".png"), frame.color);
  savePng(state_->folder / "depth" / (stamps.depth + ".png"),
          packDepth(frame, *state_->camera.depth_factor));
  state_->pairs.push_back(stamps);
}

void TumWriter::addTruth(const StampedPose& pose) { state_->truth.push_back(pose); }

void TumWriter::addMask(std::int64_t stamp_ns, const cv::Mat& mask) {
  makeFolder(state_->folder / "mask");
  savePng(state_->folder / "mask" / (formatStamp(stamp_ns) + ".png"), mask);
}

void TumWriter::addPeople(const People& people) { state_->people.push_back(people); }

void TumWriter::finish() {
  const auto list = [&](const std::string& file, const std::string& columns, const auto& line) {
    AtomicFile out(state_->folder / file);
    out.stream() << "# " << columns << "\n";
    for (const auto& pair : state_->pairs) out.stream() << line(pair) << "\n";
    out.commit();
  };
  using Pair = const State::Pair&;
  const auto rgb = [](Pair p) { return p.color + " rgb/" + p.color + ".png"; };
  const auto depth = [](Pair p) { return p.depth + " depth/" + p.depth + ".png"; };
  list("rgb.txt", "timestamp filename", rgb);
  list("depth.txt", "timestamp filename", depth);
  list("associations.txt", "timestamp filename timestamp filename",
       [&](Pair p) { return rgb(p) + " " + depth(p); });
  if (!state_->truth.empty()) {
    saveTrajectory(state_->folder / "groundtruth.txt", state_->truth, "camera to world");
  }
  if (!state_->people.empty()) savePeople(state_->folder / "people.json", state_->people);
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/known_cameras.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <vector>

namespace pf {
namespace {

constexpr double kStepsPerMetre = 5000;

struct ListedCamera {
  const char* recorded_by;
  std::vector<std::string> beginnings;  ///< of a folder's name, in small letters
  double fx, fy, cx, cy;
  std::array<double, 8> distortion;
};

/// TUM publishes the images of fr3 without distortion.
const std::vector<ListedCamera>& entries() {
  static const std::vector<ListedCamera> all = {
      {"TUM fr1",
       {"rgbd_dataset_freiburg1", "freiburg1", "fr1"},
       517.3,
       516.5,
       318.6,
       255.3,
       {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}},
      {"TUM fr2",
       {"rgbd_dataset_freiburg2", "freiburg2", "fr2"},
       520.9,
       521.0,
       325.1,
       249.7,
       {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}},
      {"TUM fr3", {"rgbd_dataset_freiburg3", "freiburg3", "fr3"}, 535.4, 539.2, 320.1, 247.6, {}},
      {"Bonn",
       {"rgbd_bonn"},
       542.822841,
       542.576870,
       315.593520,
       237.756098,
       {0.039903, -0.099343, -0.000730, -0.000144, 0.0}}};
  return all;
}

bool beginsWith(const std::string& name, const std::string& beginning) {
  if (name.rfind(beginning, 0) != 0) return false;
  // fr1 is not the beginning of fr10.
  return name.size() == beginning.size() ||
         std::isdigit(static_cast<unsigned char>(name[beginning.size()])) == 0;
}

CameraFile cameraOf(const ListedCamera& entry) {
  CameraFile file;
  file.camera.width = 640;
  file.camera.height = 480;
  file.camera.fx = entry.fx;
  file.camera.fy = entry.fy;
  file.camera.cx = entry.cx;
  file.camera.cy = entry.cy;
  file.camera.distortion = entry.distortion;
  file.depth_factor = kStepsPerMetre;
  return file;
}

}  // namespace

std::optional<KnownCamera> knownCamera(const std::string& folder) {
  std::error_code ignored;
  std::filesystem::path path = std::filesystem::absolute(folder, ignored).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // a slash at the end
  for (; path.has_filename(); path = path.parent_path()) {
    std::string name = path.filename().string();
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const ListedCamera& entry : entries()) {
      for (const std::string& beginning : entry.beginnings) {
        if (beginsWith(name, beginning)) return KnownCamera{entry.recorded_by, cameraOf(entry)};
      }
    }
  }
  return std::nullopt;
}

}  // namespace pf

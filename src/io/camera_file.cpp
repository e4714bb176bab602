// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/camera_file.hpp"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <iomanip>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

using Names = std::vector<std::string>;

constexpr std::array<const char*, 5> kDistortionNames = {"k1", "k2", "p1", "p2", "k3"};

/// A camera file whose keys go by several names.
class CameraReader {
 public:
  explicit CameraReader(const std::string& path) : path_(path) {
    std::string text = readFile(path);
    // OpenCV writes "%YAML:1.0", which is no YAML.
    if (text.rfind("%YAML", 0) == 0) text.erase(0, text.find('\n'));
    try {
      root_ = YAML::Load(text);
    } catch (const YAML::Exception& error) {
      throw InputError(path + ": not YAML: " + error.what());
    }
    if (!root_.IsMap()) throw InputError(path + ": expected 'name: value' lines of a camera");
  }

  std::optional<double> find(const Names& names) const {
    for (const auto& name : names) {
      if (root_[name]) return value(name, root_[name]);
    }
    return std::nullopt;
  }

  /// The number of that name, or the element of the matrix of that name.
  double require(const Names& names, const std::string& matrix = "", std::size_t index = 0) const {
    if (const auto found = find(names)) return *found;
    const auto data = list(matrix);
    if (index < data.size()) return data[index];
    throw InputError(path_ + ": " + names.front() + " is missing, expected a number of pixels");
  }

  std::vector<double> list(const std::string& name) const {
    std::vector<double> values;
    if (name.empty() || !root_[name]) return values;
    const YAML::Node node = root_[name];
    const YAML::Node data = node.IsMap() ? node["data"] : node;
    if (!data || !data.IsSequence()) throw InputError(path_ + ": " + name + " has no list 'data'");
    for (const auto& entry : data) values.push_back(value(name, entry));
    return values;
  }

 private:
  double value(const std::string& name, const YAML::Node& node) const {
    try {
      return node.as<double>();
    } catch (const YAML::Exception&) {
      throw InputError(path_ + ": " + name + " is no number");
    }
  }

  std::string path_;
  YAML::Node root_;
};

std::array<double, 5> readDistortion(const CameraReader& reader, const std::string& path) {
  std::array<double, 5> distortion{};
  const auto listed = reader.list("distortion_coefficients");
  if (listed.size() > distortion.size()) {
    throw InputError(path + ": distortion_coefficients has " + std::to_string(listed.size()) +
                     " values, expected at most 5 (k1 k2 p1 p2 k3)");
  }
  std::copy(listed.begin(), listed.end(), distortion.begin());
  for (std::size_t i = 0; i < distortion.size(); ++i) {
    const std::string name = kDistortionNames[i];
    if (const auto value = reader.find({name, "Camera." + name})) distortion[i] = *value;
  }
  return distortion;
}

}  // namespace

CameraFile loadCamera(const std::string& path) {
  const CameraReader reader(path);
  CameraFile file;
  PinholeCamera& camera = file.camera;
  camera.width = static_cast<int>(reader.require({"width", "image_width", "Camera.width"}));
  camera.height = static_cast<int>(reader.require({"height", "image_height", "Camera.height"}));
  camera.fx = reader.require({"fx", "Camera.fx"}, "camera_matrix", 0);
  camera.fy = reader.require({"fy", "Camera.fy"}, "camera_matrix", 4);
  camera.cx = reader.require({"cx", "Camera.cx"}, "camera_matrix", 2);
  camera.cy = reader.require({"cy", "Camera.cy"}, "camera_matrix", 5);
  camera.distortion = readDistortion(reader, path);
  file.depth_factor = reader.find({"depth_factor", "DepthMapFactor"});
  if (file.depth_factor && !(*file.depth_factor > 0 && std::isfinite(*file.depth_factor))) {
    throw InputError(path + ": depth_factor is " + std::to_string(*file.depth_factor) +
                     ", expected steps of the depth in a metre, above 0");
  }
  try {
    validate(camera);
  } catch (const InputError& error) {
    throw InputError(path + ": " + error.what());
  }
  return file;
}

void saveCamera(const std::string& path, const CameraFile& file) {
  const PinholeCamera& c = file.camera;
  AtomicFile out(path);
  out.stream() << std::setprecision(17) << "width: " << c.width << "\nheight: " << c.height
               << "\nfx: " << c.fx << "\nfy: " << c.fy << "\ncx: " << c.cx << "\ncy: " << c.cy
               << "\n";
  for (std::size_t i = 0; c.isDistorted() && i < c.distortion.size(); ++i) {
    out.stream() << kDistortionNames[i] << ": " << c.distortion[i] << "\n";
  }
  if (file.depth_factor) out.stream() << "depth_factor: " << *file.depth_factor << "\n";
  out.commit();
}

}  // namespace pf

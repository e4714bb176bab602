// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/camera_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/frame/sensor_config.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

using Names = std::vector<std::string>;

constexpr double kMostBeside_m = 1.0;  // of two cameras in one housing

const Names kPolynomialNames = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
const Names kEquidistantNames = {"k1", "k2", "k3", "k4"};

const Names& coefficientNames(LensModel lens) {
  return lens == LensModel::kEquidistant ? kEquidistantNames : kPolynomialNames;
}

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

  std::optional<std::string> text(const std::string& name) const {
    if (!root_[name]) return std::nullopt;
    if (!root_[name].IsScalar()) throw InputError(path_ + ": " + name + " is no word");
    return root_[name].as<std::string>();
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

void readLens(const CameraReader& reader, const std::string& path, PinholeCamera& camera) {
  for (const char* key : {"distortion_model", "Camera.type"}) {
    const auto model = reader.text(key);
    if (!model) continue;
    const auto lens = lensModelNamed(*model);
    if (!lens) {
      throw InputError(path + ": " + key + " is '" + *model +
                       "', expected plumb_bob, rational_polynomial or equidistant");
    }
    camera.lens = *lens;
  }
  const Names& names = coefficientNames(camera.lens);
  const auto listed = reader.list("distortion_coefficients");
  if (listed.size() > names.size()) {
    std::string expected;
    for (const auto& name : names) expected += " " + name;
    throw InputError(path + ": distortion_coefficients has " + std::to_string(listed.size()) +
                     " values, expected at most " + std::to_string(names.size()) + ":" + expected);
  }
  std::copy(listed.begin(), listed.end(), camera.distortion.begin());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (const auto value = reader.find({names[i], "Camera." + names[i]})) {
      camera.distortion[i] = *value;
    }
  }
}

std::string readSensorKind(const CameraReader& reader, const std::string& path) {
  const auto kind = reader.text("sensor");
  if (!kind) return {};
  const auto& kinds = sensorKinds();
  if (std::find(kinds.begin(), kinds.end(), *kind) != kinds.end()) return *kind;
  std::string expected;
  for (const auto& each : kinds) expected += (expected.empty() ? "" : ", ") + each;
  throw InputError(path + ": sensor is '" + *kind + "', expected one of " + expected);
}

std::optional<ColorCamera> readColorCamera(const CameraReader& reader, const std::string& path) {
  if (!reader.find({"color_fx"})) return std::nullopt;
  ColorCamera color{reader.require({"color_fx"}), reader.require({"color_fy"}),
                    reader.require({"color_cx"}), reader.require({"color_cy"}),
                    reader.find({"color_depth_right_m"}).value_or(0.0)};
  for (const double f : {color.fx, color.fy}) {
    if (f > 0 && std::isfinite(f)) continue;
    throw InputError(path + ": the focal length of colour is " + std::to_string(f) +
                     ", expected pixels, above 0");
  }
  if (!std::isfinite(color.cx) || !std::isfinite(color.cy)) {
    throw InputError(path + ": color_cx, color_cy are " + std::to_string(color.cx) + ", " +
                     std::to_string(color.cy) + ", expected pixels");
  }
  if (!(std::abs(color.depth_right_m) <= kMostBeside_m)) {
    throw InputError(path + ": color_depth_right_m is " + std::to_string(color.depth_right_m) +
                     ", expected metres, 1 at most");
  }
  return color;
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
  readLens(reader, path, camera);
  file.depth_factor = reader.find({"depth_factor", "DepthMapFactor"});
  if (file.depth_factor && !(*file.depth_factor > 0 && std::isfinite(*file.depth_factor))) {
    throw InputError(path + ": depth_factor is " + std::to_string(*file.depth_factor) +
                     ", expected steps of the depth in a metre, above 0");
  }
  file.sensor_kind = readSensorKind(reader, path);
  file.color = readColorCamera(reader, path);
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
  if (c.isDistorted()) out.stream() << "distortion_model: " << c.lensName() << "\n";
  for (std::size_t i = 0; c.isDistorted() && i < c.lensCoefficients(); ++i) {
    out.stream() << coefficientNames(c.lens)[i] << ": " << c.distortion[i] << "\n";
  }
  if (file.depth_factor) out.stream() << "depth_factor: " << *file.depth_factor << "\n";
  if (file.color) {
    const ColorCamera& color = *file.color;
    out.stream() << "color_fx: " << color.fx << "\ncolor_fy: " << color.fy
                 << "\ncolor_cx: " << color.cx << "\ncolor_cy: " << color.cy
                 << "\ncolor_depth_right_m: " << color.depth_right_m << "\n";
  }
  if (!file.sensor_kind.empty()) out.stream() << "sensor: " << file.sensor_kind << "\n";
  out.commit();
}

}  // namespace pf

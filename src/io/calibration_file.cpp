// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/calibration_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "posefusion/config/yaml_map.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"

namespace pf {
namespace {

constexpr char kModel[] = "inverse_depth_spline";
constexpr int kMostNodes = 1000;        // in a direction: more than pixels that a cell needs
constexpr double kLargest_per_m = 0.1;  // at 4 m the depth would be wrong by 40 %
constexpr double kMost = 1e9;           // of counts

/// The number of a key that has to be there.
double required(YamlMap& map, const std::string& key, double min, double max) {
  if (!map.has(key)) map.fail(key, "is missing, expected a number");
  return map.number(key, 0, min, max);
}

int requiredCount(YamlMap& map, const std::string& key, int min, int max) {
  if (!map.has(key)) map.fail(key, "is missing, expected a whole number");
  return map.integer(key, min, min, max);
}

PinholeCamera readCamera(YamlMap map) {
  PinholeCamera camera;
  camera.width = requiredCount(map, "width", 1, 100000);
  camera.height = requiredCount(map, "height", 1, 100000);
  camera.fx = required(map, "fx", 1e-3, 1e6);
  camera.fy = required(map, "fy", 1e-3, 1e6);
  camera.cx = required(map, "cx", -1e6, 1e6);
  camera.cy = required(map, "cy", -1e6, 1e6);
  map.finish();
  return camera;
}

DepthField readField(YamlMap& map) {
  const int columns = requiredCount(map, "columns", 4, kMostNodes);
  const int rows = requiredCount(map, "rows", 4, kMostNodes);
  const auto count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  std::vector<double> nodes = map.numbers("nodes_per_m", count);
  for (const double node : nodes) {
    if (std::abs(node) <= kLargest_per_m) continue;
    std::ostringstream text;
    text << "has " << node << ", expected 1/m between " << -kLargest_per_m << " and "
         << kLargest_per_m;
    map.fail("nodes_per_m", text.str());
  }
  return {columns, rows, std::move(nodes)};
}

/// A text as YAML may have it anywhere.
std::string quoted(const std::string& text) {
  YAML::Emitter out;
  out << YAML::DoubleQuoted << text;
  return out.c_str();
}

}  // namespace

DepthCalibration parseCalibration(const std::string& text, const std::string& origin) {
  YamlMap map(parseYaml(text, origin), origin + ": ");
  DepthCalibration calibration;
  if (!map.has("model")) map.fail("model", "is missing, expected " + std::string(kModel));
  map.word("model", kModel, {kModel});
  calibration.name = map.text("camera", "");
  calibration.camera = readCamera(map.map("image"));
  calibration.field = readField(map);
  calibration.keyframes = static_cast<std::size_t>(map.number("keyframes", 0, 0, kMost));
  calibration.pairs = static_cast<std::size_t>(map.number("pairs", 0, 0, kMost));
  calibration.before_mm = map.number("residual_before_mm", 0, 0, kMost);
  calibration.after_mm = map.number("residual_after_mm", 0, 0, kMost);
  calibration.left_per_m = map.number("left_per_m", 0, 0, kLargest_per_m);
  map.finish();
  try {
    validate(calibration.camera);
  } catch (const InputError& error) {
    throw InputError(origin + ": image: " + error.what());
  }
  return calibration;
}

DepthCalibration loadCalibration(const std::string& path) {
  return parseCalibration(readFile(path), path);
}

std::string calibrationText(const DepthCalibration& calibration) {
  const PinholeCamera& c = calibration.camera;
  std::ostringstream out;
  out << std::setprecision(10)
      << "# Systematic error of a depth camera: 1/z_true = 1/z + d(u, v), a cubic spline over the "
         "image.\n"
      << "model: " << kModel << "\ncamera: " << quoted(calibration.name)
      << "\nimage: {width: " << c.width << ", height: " << c.height << ", fx: " << c.fx
      << ", fy: " << c.fy << ", cx: " << c.cx << ", cy: " << c.cy << "}\n"
      << "keyframes: " << calibration.keyframes << "\npairs: " << calibration.pairs
      << "\nresidual_before_mm: " << calibration.before_mm
      << "\nresidual_after_mm: " << calibration.after_mm << "\n"
      << "left_per_m: " << calibration.left_per_m << "\ncolumns: " << calibration.field.columns()
      << "\nrows: " << calibration.field.rows() << "\nnodes_per_m: [";
  const auto columns = static_cast<std::size_t>(calibration.field.columns());
  const auto& nodes = calibration.field.nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    out << (i == 0 ? "\n  " : i % columns == 0 ? ",\n  " : ", ") << nodes[i];
  }
  out << "]\n";
  return out.str();
}

void saveCalibration(const std::string& path, const DepthCalibration& calibration) {
  AtomicFile file(path);
  file.stream() << calibrationText(calibration);
  file.commit();
}

}  // namespace pf

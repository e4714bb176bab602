// SPDX-License-Identifier: BSD-3-Clause
#include "map_calibration.hpp"

#include <cstdio>
#include <optional>

#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/saved_map_file.hpp"
#include "posefusion/run/field_picture.hpp"

namespace pf {
namespace {

void print(const DepthCalibration& c) {
  const double rms = c.field.rms();
  std::printf("calibration  camera %s, RMS %.1f mm at 2 m, %.1f mm at 4 m\n",
              c.name.empty() ? "without a name" : c.name.c_str(), 4000.0 * rms, 16000.0 * rms);
  if (c.pairs == 0) return;
  std::printf("             of %zu keyframes, %zu pairs: kept-out residual %.2f to %.2f mm\n",
              c.keyframes, c.pairs, c.before_mm, c.after_mm);
}

/// Of a map file; nothing where its depth is as it was measured.
std::optional<DepthCalibration> calibrationOf(const MapContent& content, const std::string& file) {
  try {
    return calibrationOf(content);
  } catch (const InputError& error) {
    throw InputError(file + ": " + error.what());
  }
}

}  // namespace

void printCalibration(const MapContent& content, const std::string& file) {
  if (const auto calibration = calibrationOf(content, file)) return print(*calibration);
  std::printf("calibration  none: depth is as it was measured\n");
}

void exportCalibration(const std::string& file, const std::string& output,
                       const std::string& picture) {
  const auto calibration = calibrationOf(MapReader(file).content(), file);
  if (!calibration) throw InputError(file + ": has no calibration: depth is as it was measured");
  saveCalibration(output, *calibration);
  if (!picture.empty()) savePng(picture, drawFields(calibration->field, {}));
  print(*calibration);
}

}  // namespace pf

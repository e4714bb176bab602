// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "posefusion/calibration/depth_calibration.hpp"

namespace pf {

/// A calibration as YAML; the same calibration gives the same bytes.
std::string calibrationText(const DepthCalibration& calibration);

/// Reads what calibrationText() writes; `origin` (a file) goes into messages. Throws InputError
/// naming it, the key, its value and what was expected.
DepthCalibration parseCalibration(const std::string& text, const std::string& origin);

/// Reads a file of saveCalibration(). Throws InputError as parseCalibration() does.
DepthCalibration loadCalibration(const std::string& path);

/// Writes calibrationText(), whole or not at all. Throws InputError naming the file.
void saveCalibration(const std::string& path, const DepthCalibration& calibration);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "posefusion/io/camera_file.hpp"
#include "posefusion/io/frame_source.hpp"
#include "posefusion/slam/config.hpp"

namespace pf {

/// Each adds a part of the package to its module.
void addRecording(pybind11::module& module);
void addSlam(pybind11::module& module);
void addEvaluation(pybind11::module& module);

/// A camera as Python keeps it: with the unit of its 16-bit depth.
struct PythonCamera {
  PinholeCamera pinhole;
  double depth_unit_m = 1e-3;
};

/// A recording that is being read.
struct PythonRecording {
  std::unique_ptr<FrameSource> source;
};

/// Settings as Python gives them: nothing, a file, or a dict of "group.name" or of dicts by group;
/// the mode, where one is named, comes after a file and before a dict. Throws InputError naming the
/// setting.
Config configOf(const pybind11::object& given, const pybind11::object& mode);

}  // namespace pf

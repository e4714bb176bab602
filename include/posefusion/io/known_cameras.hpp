// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "posefusion/io/camera_file.hpp"

namespace pf {

/// A camera that a benchmark publishes beside its recordings, not in them.
struct KnownCamera {
  std::string recorded_by;  ///< for people: "TUM fr3"
  CameraFile file;
};

/// The camera of a folder as TUM's and Bonn's archives name it: `rgbd_dataset_freiburg3_...`, a
/// `fr3` at the start of its name or of that of a folder around it, `rgbd_bonn_...`. Nothing for
/// another name. Depth is in 5000 steps a metre. Sources: J. Sturm et al., "A Benchmark for the
/// Evaluation of RGB-D SLAM Systems", IROS 2012, and the page of its file formats; E. Palazzolo et
/// al., "ReFusion", IROS 2019, and the page of its dataset.
std::optional<KnownCamera> knownCamera(const std::string& folder);

}  // namespace pf

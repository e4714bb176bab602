// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "posefusion/io/frame_source.hpp"

namespace pf {

/// The frames of a recording without lens distortion and with their depth corrected by a
/// calibration file; with no file (empty) the recording as it is. Throws InputError naming the file
/// when it cannot be used; next() does so for frames of another camera.
std::unique_ptr<FrameSource> calibrated(std::unique_ptr<FrameSource> source,
                                        const std::string& calibration_file);

}  // namespace pf

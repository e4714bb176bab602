// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "posefusion/evaluation/masks.hpp"

namespace pf {

/// Checks the masks of a run (`mask_folder`: its output folder, or the folder of <stamp>.png files)
/// against a sequence (`truth_folder`: with mask/, or a folder of <stamp>.png files, or a sequence
/// without mask/: then no person is in it). The detected people come from people.json beside the
/// masks and the sequence's depth, where both exist. Throws InputError naming what is missing.
MaskCheck checkMasks(const std::string& truth_folder, const std::string& mask_folder);

/// What of the masks of a run (its output folder) lies on things that move, by thing_mask/ of a
/// simulated sequence, and on what stands still: neither people nor things that move.
struct ThingMaskScore {
  int frames = 0;
  double masked_things = 0;  ///< part of the pixels of things that move; 0 of none
  double masked_still = 0;   ///< part of all other pixels but people's
};

/// Throws InputError naming what is missing.
ThingMaskScore checkThingMasks(const std::string& sequence, const std::string& run);

/// The mask `folder`/<stamp>.png (CV_8UC1); empty where there is none. Throws InputError naming a
/// file that cannot be read.
cv::Mat loadMask(const std::string& folder, std::int64_t stamp_ns);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/frame/working_frame.hpp"

namespace pf {

/// `seen_m`: depth of the frame, that past the mapped range, and that of what was taken out
/// (`input_m`, may be empty): whatever a ray meets, a person or the rim of one, all before that is
/// free. `free_m`: where all of 3x3 pixels see at least that far (m); 0 where the centre sees
/// nothing. CV_32FC1.
void findFreeSpace(const WorkingFrame& frame, const cv::Mat& input_m, cv::Mat& seen_m,
                   cv::Mat& free_m);

/// `gaps`: CV_8UC1, 255 where none of 3x3 pixels sees anything, and none is under the mask of
/// people (CV_8UC1, a multiple of the size; may be empty): out of range, hidden by something too
/// near, shiny, dark, or in the shadow of the projector. `people`: work memory.
void findGaps(const cv::Mat& seen_m, const cv::Mat& mask, cv::Mat& people, cv::Mat& gaps);

}  // namespace pf

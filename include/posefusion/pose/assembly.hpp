// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "posefusion/pose/config.hpp"
#include "posefusion/pose/network.hpp"
#include "posefusion/pose/peaks.hpp"

namespace pf {

/// How well the affinity field supports a limb between two peaks: the mean of the field along the
/// line, projected on the line's direction, over the samples that agree with it; 0 unless nearly
/// all samples agree (Cao et al. 2017, eq. 10; sample counts and thresholds as published by
/// OpenPose).
float limbScore(const cv::Mat& field_x, const cv::Mat& field_y, const Peak& from, const Peak& to);

/// Joins the peaks of all parts (`peaks[part]`, heat-map pixels) to people by greedy matching limb
/// by limb, best limbs first. People with too few parts or too small a score are dropped; at most
/// `max_people` are kept, best first. Joints are in pixels of the image of size `image`.
std::vector<Person> assemblePeople(const PoseMaps& maps, const ModelSettings& settings,
                                   const std::vector<std::vector<Peak>>& peaks,
                                   const cv::Size& image, const PoseConfig& config);

}  // namespace pf

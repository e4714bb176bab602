// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/core/camera.hpp"
#include "posefusion/pose/person_model.hpp"
#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// Separates people in the model's maps: every cell of the mask votes for the centre of its body,
/// votes that meet in space (metres, by the depth of the cell) are one person, and a peak of a
/// joint belongs to the person whose centre it votes for. A group without joints is no person. The
/// score is the mean of the six best joints: few joints are a guess, as the backs of chairs and the
/// edges of boxes look like bodies but have few.
/// `small_m`: the depth that the maps were computed from (see shrinkDepth); `camera`: of the frame.
/// At most `max_people` are kept, those with most evidence first.
People groupPeople(const PersonMaps& maps, const cv::Mat& small_m, const PinholeCamera& camera,
                   int max_people);

}  // namespace pf

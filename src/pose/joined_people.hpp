// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// The people of a network and of the embedded model as one. Whoever both saw gets the network's
/// joints, and the embedded model's where the network has none; the mask is the embedded model's.
/// Where the network did not look, the embedded model's answer alone. `image`: size of the frame.
People joinPeople(const People& network, People embedded, const cv::Size& image, int max_people);

}  // namespace pf

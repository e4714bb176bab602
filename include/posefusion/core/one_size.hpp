// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "posefusion/core/frame.hpp"

namespace pf {

/// Colour and depth of one optical frame whose images differ in size, brought to the pixels of the
/// smaller: colour by the mean of the pixels that fall together, depth by the nearest. The larger
/// image may see more than the smaller one. `frame.camera` is that of colour, `depth_camera` that
/// of depth, as its driver says; the frame that is returned has the camera of the smaller image. A
/// shift of less than half a pixel of the larger image is left. Throws InputError naming both
/// sizes, and what does not relate: the shape of the pixels, the distortion, or what is seen.
RgbdFrame bringToOneSize(const RgbdFrame& frame, const PinholeCamera& depth_camera);

}  // namespace pf

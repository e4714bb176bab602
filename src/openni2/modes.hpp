// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <OpenNI.h>

#include "posefusion_openni2/frame.hpp"
#include "posefusion_openni2/settings.hpp"

namespace pf::openni2 {

/// The pixels that are published as they are: R G B bytes, depth in millimetres.
openni::PixelFormat formatOf(StreamKind kind);

/// All modes of the sensor as text, with their pixel formats.
std::string offersOf(const openni::SensorInfo& sensor);

/// The sensor's mode of this size and rate. Throws InputError that lists what it offers.
openni::VideoMode chooseMode(const openni::SensorInfo& sensor, StreamKind kind,
                             const StreamMode& wanted);

}  // namespace pf::openni2

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "posefusion/io/frame_source.hpp"
#include "posefusion/slam/pipeline.hpp"

namespace pf {

/// Called for each frame in order. `defect` says why a frame could not be read (its outcome is
/// bad_input then). Return false to stop.
using FrameDone = std::function<bool(const ProcessedFrame& frame, const std::string& defect)>;

/// The settings, with the kind of depth camera that the recording names where they leave it open.
Config configFor(Config config, const FrameSource& source);

/// Runs the chain over a recording on three threads: reading and decoding ahead, Pipeline::see()
/// ahead, Pipeline::map() and `done` in the caller's. The result is that of one thread, to the bit.
/// What any of them throws is thrown here, after `done` has seen all frames before it.
void runPipeline(FrameSource& source, Pipeline& pipeline, const FrameDone& done);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "posefusion/io/map_database.hpp"
#include "sqlite.hpp"

namespace pf {

/// The rows of a map file's tables as values. Each throws InputError saying what cannot be, without
/// the file; columns come in the order of the lists beside them. @{

constexpr char kStateColumns[] =
    "frame, graph_version, gain, offset, settings, width, height, intrinsics";
/// Into `content`: all that this one row holds.
void stateAt(const SqliteStatement& row, MapContent& content);

/// Of the version of a file; before version 3 no keyframe was retired.
const char* keyframeColumns(std::int64_t version);
Keyframe keyframeAt(const SqliteStatement& row);

constexpr char kConstraintColumns[] = "kind, from_keyframe, to_keyframe, t_from_to, covariance";
PoseConstraint constraintAt(const SqliteStatement& row);

constexpr char kFrameColumns[] = "stamp_ns, keyframe, t_keyframe_camera";
FrameRecord frameAt(const SqliteStatement& row);

/// Of the version of a file; in version 1 all blocks count as the first fragment's.
const char* blockColumns(std::int64_t version);
/// Surfels of frames up to `last_frame`.
BlockRecord blockAt(const SqliteStatement& row, std::int64_t version, int last_frame);

constexpr char kImageColumns[] = "keyframe, grey, depth";
/// `camera`: size of the frames, which no image exceeds.
KeyframeImages imagesAt(const SqliteStatement& row, const cv::Size& camera);

/// @}

}  // namespace pf

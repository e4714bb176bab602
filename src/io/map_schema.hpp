// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace pf {

/// "PFdb" in the header of the file, and the version of what follows.
constexpr std::int64_t kMapApplication = 0x50466462;
constexpr std::int64_t kMapVersion = 4;
constexpr std::int64_t kFirstMapVersion = 1;  ///< the oldest that is read (see map_upgrade.hpp)

/// The tables as SQLite keeps them: a file with any other is refused, so that nothing hostile can
/// hide in a view or a trigger. Transforms are 12 doubles (3x4, row by row), covariances 36.
constexpr std::array<const char*, 7> kMapTables = {
    "CREATE TABLE state(id INTEGER PRIMARY KEY, frame INTEGER, graph_version INTEGER, gain REAL,"
    " offset REAL, settings BLOB, width INTEGER, height INTEGER, intrinsics BLOB)",
    "CREATE TABLE blocks(id INTEGER PRIMARY KEY, fragment INTEGER, surfels BLOB,"
    " checksum INTEGER)",
    "CREATE TABLE keyframes(id INTEGER PRIMARY KEY, fragment INTEGER, stamp_ns INTEGER,"
    " map_frame INTEGER, t_map_camera BLOB, follows INTEGER)",
    "CREATE TABLE images(keyframe INTEGER PRIMARY KEY, grey BLOB, depth BLOB)",
    "CREATE TABLE constraints(id INTEGER PRIMARY KEY, kind INTEGER, from_keyframe INTEGER,"
    " to_keyframe INTEGER, t_from_to BLOB, covariance BLOB)",
    "CREATE TABLE frames(id INTEGER PRIMARY KEY, stamp_ns INTEGER, keyframe INTEGER,"
    " t_keyframe_camera BLOB)",
    "CREATE TABLE blobs(name TEXT PRIMARY KEY, data BLOB) WITHOUT ROWID"};

/// Of those, what older versions had otherwise: of blocks version 1, of keyframes versions 1 and 2.
/// @{
constexpr std::size_t kBlocksTable = 1, kKeyframesTable = 2;
constexpr const char* kFirstBlocksTable =
    "CREATE TABLE blocks(id INTEGER PRIMARY KEY, surfels BLOB, checksum INTEGER)";
constexpr const char* kFirstKeyframesTable =
    "CREATE TABLE keyframes(id INTEGER PRIMARY KEY, fragment INTEGER, stamp_ns INTEGER,"
    " map_frame INTEGER, t_map_camera BLOB)";
constexpr std::int64_t kFragmentsVersion = 2;  ///< the first with fragments of blocks
constexpr std::int64_t kRetiredVersion = 3;    ///< the first with retired keyframes
constexpr std::int64_t kOddsVersion = 4;       ///< the first with the odds of surfels
/// @}

}  // namespace pf

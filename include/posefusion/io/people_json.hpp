// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "posefusion/pose/detector.hpp"

namespace pf {

/// Recorded people of a sequence, `people.json`:
///
///   {"joints": ["nose", "neck", ...18 names of skeleton.hpp],
///    "frames": [{"stamp": "1.033333",
///                "people": [{"score": 0.9, "joints": [[u, v, p], ...18]}]}]}
///
/// A frame that is not listed was not looked at by the detector; one with no people was.
/// Throws InputError naming the file and the entry.
RecordedPeople loadPeople(const std::string& path);

/// Writes to a temporary name and renames it. Throws InputError naming the file.
void savePeople(const std::string& path, const std::vector<People>& frames);

}  // namespace pf

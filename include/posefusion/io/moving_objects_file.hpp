// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "posefusion/io/files.hpp"
#include "posefusion/segmentation/moving_object.hpp"

namespace pf {

/// Writes the people and moving objects of a recording, `moving_objects.json`, a line for each
/// frame that has any:
///
///   {"joints": ["nose", "neck", ...18 names of skeleton.hpp],
///    "frames": [{"stamp": "1.033333",
///                "objects": [{"id": 1, "is_person": true, "centre": [x, y, z],
///                             "box": [[x, y, z], [x, y, z]], "velocity": [x, y, z],
///                             "joints": [[x, y, z], null, ...18]}]}]}
///
/// Metres and metres a second, in the frame that the objects are in; `joints` of people alone, null
/// where one is not seen or has no depth. Not thread safe.
class MovingObjectsFile {
 public:
  /// Throws InputError naming the file when it cannot be made.
  explicit MovingObjectsFile(const std::string& path);

  void add(std::int64_t stamp_ns, const std::vector<MovingObject>& objects);

  /// Throws InputError naming the file when something could not be written. Without it there is
  /// no file.
  void finish();

 private:
  AtomicFile file_;
  bool has_frames_ = false;
};

}  // namespace pf

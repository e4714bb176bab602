// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>

#include "posefusion/core/frame.hpp"
#include "posefusion/pose/config.hpp"
#include "posefusion/pose/skeleton.hpp"

namespace pf {

/// A source of people: networks, a recording, or none. Called for sharp frames in order, from one
/// thread at a time.
class PoseDetector {
 public:
  virtual ~PoseDetector() = default;
  /// The people in the frame. `detected` is false on frames that the source has nothing to say of.
  virtual People detect(const RgbdFrame& frame) = 0;
  /// From the next frame on; the detector, its model and the size of its input stay.
  virtual void set(const PoseConfig& /*config*/) {}
  /// The same when a newer frame waits already: nothing that takes long is done.
  virtual People detectInHaste(const RgbdFrame& frame) { return detect(frame); }
};

/// People recorded with the input, by stamp (ns).
using RecordedPeople = std::map<std::int64_t, People>;

/// Makes the detector that the configuration names. Throws InputError naming the file, and how to
/// get one, where a model is missing or unreadable. `recorded` is used by the "recorded" detector
/// only.
std::unique_ptr<PoseDetector> makePoseDetector(const PoseConfig& config, RecordedPeople recorded);

}  // namespace pf

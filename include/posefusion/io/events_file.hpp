// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pf {

/// What happened in a recording, as far as an evaluation asks for it. Nanoseconds, in order.
struct RecordedEvents {
  std::vector<std::int64_t> blurred_ns;      ///< stamps of the frames that are blurred
  std::vector<std::int64_t> fall_starts_ns;  ///< when the camera begins to fall
  std::vector<std::int64_t> fall_ends_ns;    ///< when it is up again, of each fall
};

/// Reads `events.json` as the simulator writes it (docs/simulator.md):
///
///   {"events": [{"kind": "fall", "start": "1009.000000", "end": "1015.050000"}, ...]}
///
/// Events of other kinds are passed over. Throws InputError naming the file.
RecordedEvents loadEvents(const std::string& path);

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <optional>
#include <string>

#include "posefusion_openni2/device.hpp"

namespace pf::openni2 {

/// One stream, as diagnostics show it.
struct StreamStatus {
  StreamMode mode;
  StreamCounters counters;
  double rate_hz = 0.0;
  double latency_ms = 0.0;  ///< from the driver's callback to the published pointer, median
};

/// What diagnostics report of the driver.
struct DriverStatus {
  enum class State { looking, streaming, ended };

  State state = State::looking;
  std::string message;  ///< why there is no device
  DeviceIdentity identity;
  StreamStatus color;
  StreamStatus depth;
  int connections = 0;
  double delay_ms = 0.0;  ///< of the last frame after its stamp, without the offsets
  bool registered = false;
  bool synchronised = false;
  std::optional<double> temperature_c;
  std::optional<int> exposure;
  bool exposure_limited = false;
  std::string recording;
};

/// Level, message and values.
void report(const DriverStatus& status, diagnostic_updater::DiagnosticStatusWrapper& out);

}  // namespace pf::openni2

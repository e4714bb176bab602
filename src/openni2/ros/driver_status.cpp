// SPDX-License-Identifier: BSD-3-Clause
#include "driver_status.hpp"

namespace pf::openni2 {
namespace {

using diagnostic_msgs::DiagnosticStatus;

/// Below this part of its rate a stream is slow.
constexpr double kSlow = 0.8;

void reportStream(const std::string& name, const StreamStatus& stream,
                  diagnostic_updater::DiagnosticStatusWrapper& out) {
  out.add(name + " mode", toText(stream.mode));
  out.addf(name + " rate (Hz)", "%.1f", stream.rate_hz);
  out.add(name + " delivered", stream.counters.delivered);
  out.add(name + " dropped", stream.counters.dropped);
  out.add(name + " duplicated", stream.counters.duplicated);
  out.add(name + " damaged", stream.counters.damaged);
  out.addf(name + " callback to pointer (ms)", "%.3f", stream.latency_ms);
  if (stream.rate_hz < kSlow * stream.mode.fps) {
    out.mergeSummaryf(DiagnosticStatus::WARN, "%s is slow: %.1f of %d Hz", name.c_str(),
                      stream.rate_hz, stream.mode.fps);
  }
}

void reportStreaming(const DriverStatus& status, diagnostic_updater::DiagnosticStatusWrapper& out) {
  out.summary(DiagnosticStatus::OK, "streaming");
  reportStream("colour", status.color, out);
  reportStream("depth", status.depth, out);
  out.addf("delay after the stamp (ms)", "%.1f", status.delay_ms);
  out.add("depth registered to colour", status.registered);
  out.add("streams synchronised", status.synchronised);
  out.add("exposure",
          status.exposure ? std::to_string(*status.exposure) : "not reported by the device");
  if (status.exposure_limited) out.add("auto exposure", "held at max_exposure");
  if (status.temperature_c) {
    out.addf("temperature (C)", "%.1f", *status.temperature_c);
  } else {
    out.add("temperature (C)", "not reported by the device");
  }
  out.add("recording", status.recording.empty() ? "none" : status.recording);
}

}  // namespace

void report(const DriverStatus& status, diagnostic_updater::DiagnosticStatusWrapper& out) {
  switch (status.state) {
    case DriverStatus::State::looking:
      out.summary(DiagnosticStatus::ERROR, status.message.empty() ? "starting" : status.message);
      break;
    case DriverStatus::State::streaming:
      reportStreaming(status, out);
      break;
    case DriverStatus::State::ended:
      out.summary(DiagnosticStatus::OK, "the file has been played");
  }
  out.add("device", status.identity.vendor + " " + status.identity.name);
  out.add("serial number", status.identity.serial);
  out.add("uri", status.identity.uri);
  out.add("connections", status.connections);
}

}  // namespace pf::openni2

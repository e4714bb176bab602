// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "posefusion/calibration/color_estimate.hpp"
#include "posefusion/loop/closer.hpp"
#include "posefusion/run/run_statistics.hpp"
#include "posefusion/slam/back_end.hpp"
#include "posefusion/slam/config.hpp"

namespace pf {

// What summary.json is made of.

/// "tracking.max_distance_m" = "0.1" becomes {"tracking": {"max_distance_m": 0.1}}.
nlohmann::ordered_json configurationJson(const Config& config);

nlohmann::ordered_json framesJson(const FrameCounts& f);

/// Table IV of the paper counts ferns and loops.
nlohmann::ordered_json loopsJson(const LoopCounts& c, const BackEnd::Counts& corrections);

/// How colour lay over depth; the colour camera where it does not.
nlohmann::ordered_json colorJson(const ColorEstimate& e, bool registers);

/// The same for people, with what to write into camera.yaml; empty where it does.
std::string colorLine(const ColorEstimate& e, bool registers);

nlohmann::ordered_json timesJson(const StageTime& time);

}  // namespace pf

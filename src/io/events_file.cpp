// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/events_file.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stamps.hpp"
#include "posefusion/io/files.hpp"

namespace pf {

RecordedEvents loadEvents(const std::string& path) {
  RecordedEvents events;
  try {
    const auto root = nlohmann::json::parse(readFile(path));
    for (const auto& event : root.at("events")) {
      const std::int64_t start_ns = parseStamp(event.at("start").get<std::string>());
      const std::string kind = event.at("kind").get<std::string>();
      if (kind == "blurred") events.blurred_ns.push_back(start_ns);
      if (kind != "fall") continue;
      events.fall_starts_ns.push_back(start_ns);
      events.fall_ends_ns.push_back(parseStamp(event.at("end").get<std::string>()));
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(path + ": " + error.what());
  }
  std::sort(events.blurred_ns.begin(), events.blurred_ns.end());
  std::sort(events.fall_starts_ns.begin(), events.fall_starts_ns.end());
  std::sort(events.fall_ends_ns.begin(), events.fall_ends_ns.end());  // falls do not overlap
  return events;
}

}  // namespace pf

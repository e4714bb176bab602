// SPDX-License-Identifier: BSD-3-Clause
#include "summary_parts.hpp"

#include <cstdio>
#include <string>

namespace pf {

using nlohmann::ordered_json;

ordered_json configurationJson(const Config& config) {
  ordered_json out;
  for (const auto& [key, text] : listFields(config)) {
    const auto value = ordered_json::parse(text, nullptr, false);
    const bool literal = value.is_number() || value.is_boolean();
    const auto dot = key.find('.');
    out[key.substr(0, dot)][key.substr(dot + 1)] = literal ? value : ordered_json(text);
  }
  return out;
}

ordered_json framesJson(const FrameCounts& f) {
  return {{"read", f.read},
          {"bad", f.bad},
          {"blurred", f.blurred},
          {"tracked", f.tracked},
          {"lost", f.lost},
          {"left_out", f.left_out},
          {"pose_share", f.poseShare()},
          {"pose_share_of_sharp", f.sharpPoseShare()},
          {"by_state", f.by_state},
          {"by_outcome", f.by_outcome}};
}

ordered_json loopsJson(const LoopCounts& c, const BackEnd::Counts& corrections) {
  ordered_json refused;
  for (std::size_t i = 1; i < c.refused.size(); ++i) {
    refused[std::string(name(static_cast<PlaceDoubt>(i)))] = c.refused[i];
  }
  refused["one_way"] = c.one_way;
  refused["turned"] = c.turned;
  refused["graph"] = corrections.refused;
  return {{"keyframes", c.keyframes},
          {"ferns", c.ferns},
          {"ferns_not_static", c.not_static},
          {"compared", c.compared},
          {"accepted", c.accepted},
          {"accepted_local", c.local},
          {"corrections", corrections.accepted},
          {"fragments_joined", corrections.joined},
          {"withdrawn", corrections.withdrawn},
          {"refused", refused},
          {"places_searched", c.searched},
          {"places_found", c.found}};
}

ordered_json colorJson(const ColorEstimate& e, bool registers) {
  ordered_json out = {{"offset_px", e.offset_px}, {"offset_known_to_px", e.unknown_px}};
  if (!e.doubt.empty()) {
    out["left_because"] = e.doubt;
    return out;
  }
  const ColorCamera& c = e.camera;
  out["registered"] = registers;
  out["color_fx"] = c.fx;
  out["color_fy"] = c.fy;
  out["color_cx"] = c.cx;
  out["color_cy"] = c.cy;
  out["color_depth_right_m"] = c.depth_right_m;
  return out;
}

std::string colorLine(const ColorEstimate& e, bool registers) {
  if (!e.doubt.empty()) return {};
  const ColorCamera& c = e.camera;
  char text[400];
  std::snprintf(text, sizeof(text),
                "colour   %s %.0f px off depth%s. In camera.yaml, for the next run:\n"
                "           color_fx: %.2f\n           color_fy: %.2f\n           color_cx: %.2f\n"
                "           color_cy: %.2f\n           color_depth_right_m: %.5f\n",
                registers ? "was" : "is", e.offset_px,
                registers ? ", registered from the first seconds on"
                          : ": --set calibration.color=learn registers it",
                c.fx, c.fy, c.cx, c.cy, c.depth_right_m);
  return text;
}

ordered_json timesJson(const StageTime& time) {
  return {{"median_ms", time.median_ms},
          {"p95_ms", time.p95_ms},
          {"p99_ms", time.p99_ms},
          {"p999_ms", time.p999_ms},
          {"most_ms", time.most_ms}};
}

}  // namespace pf

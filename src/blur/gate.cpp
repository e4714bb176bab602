// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/blur/gate.hpp"

#include <algorithm>
#include <vector>

namespace pf {

BlurGate::BlurGate(const BlurConfig& config) : config_(config) {}

double BlurGate::threshold() const {
  if (config_.threshold > 0.0) return config_.threshold;
  if (recent_.empty()) return 0.0;
  std::vector<double> values;
  for (const Past& past : recent_) values.push_back(past.fine_detail);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return config_.relative_threshold * *middle;
}

bool BlurGate::isDue(std::int64_t stamp_ns) const {
  // Stamps jitter: what is due within a millisecond is due.
  return 1e-9 * static_cast<double>(stamp_ns - passed_ns_) > config_.max_gap_s - 1e-3;
}

bool BlurGate::isOld(const Past& past, std::int64_t stamp_ns) const {
  const double age_s = 1e-9 * static_cast<double>(stamp_ns - past.stamp_ns);
  return age_s < 0.0 || age_s > config_.history_s - 1e-3;
}

BlurScore BlurGate::judge(const Sharpness& sharpness, std::int64_t stamp_ns) {
  const bool fixed = config_.threshold > 0.0;
  BlurScore result;
  result.score = sharpness.laplacian_variance;
  result.measure = fixed ? sharpness.laplacian_variance : sharpness.fine_detail;
  if (!config_.enabled) return result;
  result.threshold = threshold();
  const bool unknown = !fixed && sharpness.dull;
  const bool blurred = !unknown && result.measure < result.threshold;
  passed_ns_ = std::min(passed_ns_, stamp_ns);
  result.forced = blurred && isDue(stamp_ns);
  result.sharp = !blurred || result.forced;
  if (result.sharp) passed_ns_ = stamp_ns;
  // Dropped frames count too: what lasts longer than a burst of blur is how the scene looks now.
  if (!unknown) recent_.push_back({stamp_ns, sharpness.fine_detail});
  while (!recent_.empty() && isOld(recent_.front(), stamp_ns)) recent_.pop_front();
  return result;
}

void BlurGate::reset() {
  recent_.clear();
  passed_ns_ = kNever;
}

}  // namespace pf

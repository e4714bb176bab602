// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/blur/gate.hpp"

#include <algorithm>
#include <vector>

namespace pf {

BlurGate::BlurGate(const BlurConfig& config) : config_(config) {}

double BlurGate::threshold() const {
  if (config_.threshold > 0.0) return config_.threshold;
  if (recent_.empty()) return 0.0;
  std::vector<double> values(recent_.begin(), recent_.end());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return config_.relative_threshold * *middle;
}

bool BlurGate::isDue(std::int64_t stamp_ns) const {
  // Stamps jitter: what is due within a millisecond is due.
  return 1e-9 * static_cast<double>(stamp_ns - passed_ns_) > config_.max_gap_s - 1e-3;
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
  if (!unknown) recent_.push_back(sharpness.fine_detail);
  while (static_cast<int>(recent_.size()) > config_.history_frames) recent_.pop_front();
  return result;
}

void BlurGate::reset() {
  recent_.clear();
  passed_ns_ = kNever;
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/detector.hpp"

#include <utility>

#include "posefusion/pose/assembly.hpp"
#include "posefusion/pose/network.hpp"
#include "posefusion/pose/peaks.hpp"

namespace pf {
namespace {

constexpr int kMaxPeaksPerPart = 40;

class NoDetector : public PoseDetector {
 public:
  People detect(const RgbdFrame& frame) override { return {frame.stamp_ns, false, {}}; }
};

class RecordedDetector : public PoseDetector {
 public:
  explicit RecordedDetector(RecordedPeople recorded) : recorded_(std::move(recorded)) {}
  People detect(const RgbdFrame& frame) override {
    const auto found = recorded_.find(frame.stamp_ns);
    if (found == recorded_.end()) return {frame.stamp_ns, false, {}};
    return found->second;
  }

 private:
  RecordedPeople recorded_;
};

/// Looks at every n-th frame it is given, so that the result does not depend on the machine's
/// speed.
class NetworkDetector : public PoseDetector {
 public:
  explicit NetworkDetector(const PoseConfig& config)
      : config_(config),
        network_(config.model.empty() ? defaultModelPath() : config.model, config.input_height_px),
        peaks_(network_.settings().parts.size()) {}

  People detect(const RgbdFrame& frame) override {
    const bool turn = frames_++ % config_.every_nth_frame == 0;
    if (!turn) return {frame.stamp_ns, false, {}};
    const PoseMaps maps = network_.infer(frame.color);
    const auto& parts = network_.settings().parts;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      finder_.find(maps.plane(parts[i].channel), static_cast<float>(config_.min_peak),
                   kMaxPeaksPerPart, peaks_[i]);
    }
    return {frame.stamp_ns, true,
            assemblePeople(maps, network_.settings(), peaks_, frame.color.size(), config_)};
  }

  void set(const PoseConfig& config) override { config_ = config; }

 private:
  PoseConfig config_;
  PoseNetwork network_;
  PeakFinder finder_;
  std::vector<std::vector<Peak>> peaks_;
  std::int64_t frames_ = 0;
};

}  // namespace

std::unique_ptr<PoseDetector> makePoseDetector(const PoseConfig& config, RecordedPeople recorded) {
  if (config.detector == "recorded") return std::make_unique<RecordedDetector>(std::move(recorded));
  if (config.detector == "network") return std::make_unique<NetworkDetector>(config);
  return std::make_unique<NoDetector>();
}

}  // namespace pf

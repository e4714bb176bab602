// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/detector.hpp"

#include <utility>

#include "joined_people.hpp"
#include "posefusion/pose/assembly.hpp"
#include "posefusion/pose/network.hpp"
#include "posefusion/pose/peaks.hpp"
#include "posefusion/pose/person_groups.hpp"
#include "posefusion/pose/person_model.hpp"

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
    const bool turn = frames_++ % lookInterval_frames(config_) == 0;
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
  People detectInHaste(const RgbdFrame& frame) override { return {frame.stamp_ns, false, {}}; }

  void set(const PoseConfig& config) override { config_ = config; }

 private:
  PoseConfig config_;
  PoseNetwork network_;
  PeakFinder finder_;
  std::vector<std::vector<Peak>> peaks_;
  std::int64_t frames_ = 0;
};

/// The package's own model: looks at the depth of every frame.
class EmbeddedDetector : public PoseDetector {
 public:
  explicit EmbeddedDetector(const PoseConfig& config)
      : max_people_(config.max_people),
        model_(config.embedded_model.empty() ? packagedPersonModel() : config.embedded_model) {}

  People detect(const RgbdFrame& frame) override {
    depthInMetres(frame, kDepthInputNearest_m, kDepthInputFarthest_m, depth_m_);
    shrinkDepth(depth_m_, small_m_);
    People people = groupPeople(model_.infer(small_m_), small_m_, frame.camera, max_people_);
    people.stamp_ns = frame.stamp_ns;
    return people;
  }

  void set(const PoseConfig& config) override { max_people_ = config.max_people; }

 private:
  int max_people_;
  PersonModel model_;
  cv::Mat depth_m_, small_m_;
};

/// The embedded model on every frame, the network beside it on its own.
class JoinedDetector : public PoseDetector {
 public:
  explicit JoinedDetector(const PoseConfig& config)
      : max_people_(config.max_people), network_(config), embedded_(config) {}

  People detect(const RgbdFrame& frame) override {
    return joinPeople(network_.detect(frame), embedded_.detect(frame), frame.color.size(),
                      max_people_);
  }
  People detectInHaste(const RgbdFrame& frame) override { return embedded_.detect(frame); }

  void set(const PoseConfig& config) override {
    max_people_ = config.max_people;
    network_.set(config);
    embedded_.set(config);
  }

 private:
  int max_people_;
  NetworkDetector network_;
  EmbeddedDetector embedded_;
};

}  // namespace

std::unique_ptr<PoseDetector> makePoseDetector(const PoseConfig& config, RecordedPeople recorded) {
  const std::string detector = chosenDetector(config);
  if (detector == "recorded") return std::make_unique<RecordedDetector>(std::move(recorded));
  if (detector == "network") return std::make_unique<NetworkDetector>(config);
  if (detector == "embedded") return std::make_unique<EmbeddedDetector>(config);
  if (detector == "network+embedded") return std::make_unique<JoinedDetector>(config);
  return std::make_unique<NoDetector>();
}

}  // namespace pf

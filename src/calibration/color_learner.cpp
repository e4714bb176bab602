// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/color_learner.hpp"

#include <cstdlib>
#include <utility>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

// Of 30 frames a second every other one: frames that follow each other show the same edges.
constexpr std::int64_t kApart_ns = 50'000'000;
constexpr std::size_t kViews = 24;
// The estimate takes half a second of one core.
constexpr std::int64_t kWork_ns = 1'000'000'000;

}  // namespace

RgbdFrame ColorLearner::registered(const RgbdFrame& frame) {
  if (registration_ && !estimate_) return registration_->registered(frame);  // given
  if (!config_.looksAtColor()) return frame;
  if (!isSameCamera(camera_, frame.camera)) {
    *this = ColorLearner(config_);
    camera_ = frame.camera;
  }
  takeUp(frame.stamp_ns);
  if (registration_) return registration_->registered(frame);
  if (!estimate_ && !working_.valid()) learn(frame);
  return frame;
}

void ColorLearner::learn(const RgbdFrame& frame) {
  if (!views_.empty() && std::abs(frame.stamp_ns - last_ns_) < kApart_ns) return;
  last_ns_ = frame.stamp_ns;
  views_.push_back(edgeView(frame));
  if (views_.size() < kViews) return;
  working_ = std::async(std::launch::async, [views = std::exchange(views_, {}), camera = camera_] {
    return inOneThread([&] { return estimateColorCamera(views, camera); });
  });
}

void ColorLearner::takeUp(std::int64_t stamp_ns) {
  if (!working_.valid() || std::abs(stamp_ns - last_ns_) < kWork_ns) return;
  estimate_ = working_.get();
  if (!estimate_->doubt.empty() || !config_.registersColor()) return;
  registration_.emplace(estimate_->camera);
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/field_learner.hpp"

namespace pf {
namespace {

// Surfaces of that many keyframes are 20 MB, and their pairs two seconds of work.
constexpr std::size_t kMostViews = 160;

}  // namespace

void FieldLearner::add(const CalibrationView& view) {
  surfaces_.emplace_back(view);
  ++keyframes_;
  if (surfaces_.size() <= kMostViews) return;
  std::vector<ViewSurface> every_second;
  for (std::size_t i = 0; i < surfaces_.size(); i += 2) {
    every_second.push_back(std::move(surfaces_[i]));
  }
  surfaces_ = std::move(every_second);
}

void FieldLearner::setPoses(const std::vector<MapPose>& poses) {
  for (ViewSurface& surface : surfaces_) {
    surface.setPose(poses.at(static_cast<std::size_t>(surface.id())));
  }
}

std::optional<FieldEstimate> FieldLearner::learn(const DepthField& known) {
  if (keyframes_ == 0 || 4 * keyframes_ < 5 * estimated_at_) return std::nullopt;
  return estimate(known);
}

FieldEstimate FieldLearner::estimate(const DepthField& known) {
  estimated_at_ = keyframes_;
  FieldEstimateConfig config;
  config.known = known;
  return estimateFieldFrom(surfaces_, config);
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
// What the mapper knows of its depth camera: frames are corrected by it, and what is newly known
// comes into the map as one correction.
#include <algorithm>
#include <cstdio>
#include <utility>

#include "mapper_state.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/map/depth_step.hpp"

namespace pf {
namespace {

constexpr double kMillimetre = 1e-3;

std::string textOf(const DepthCalibration& step) {
  char text[160];
  std::snprintf(text, sizeof text,
                "depth was off by %.1f mm at 2 m: %zu pairs of keyframes, kept-out residual %.2f "
                "to %.2f mm",
                4000.0 * step.field.rms(), step.pairs, step.before_mm, step.after_mm);
  return text;
}

}  // namespace

/// The frame with its depth corrected; people's too, so that both still compare.
StaticFrame Mapper::State::corrected(const StaticFrame& input) {
  if (!calibration) return input;
  StaticFrame result = input;
  const double unit_m = input.frame.depth_unit_m;
  result.frame.depth = corrector.inMetres(input.frame.depth, unit_m);
  if (!input.input_depth.empty())
    result.input_depth = corrector.inMetres(input.input_depth, unit_m);
  return result;
}

/// Of its sensor's systematic error only what the calibration leaves is still to be reckoned with.
void Mapper::State::use(std::optional<DepthCalibration> known) {
  calibration = std::move(known);
  is_calibration_loaded = calibration.has_value();
  const DepthField field = fieldOf(calibration);
  corrector = DepthCorrector(field);
  distorter = DepthCorrector(field.inverse());
  sensor = depthSensorOf(config);
  if (!calibration || calibration->left_per_m <= 0) return;
  const auto left_1_m = static_cast<float>(calibration->left_per_m);
  sensor.systematic_1_m = std::min(sensor.systematic_1_m, left_1_m);
}

void Mapper::State::take(const LoopAnswer& answer) {
  if (!answer.calibration_doubt.empty()) last_calibration = answer.calibration_doubt;
  // Of depth as it was before, nothing more is to be learned.
  if (answer.depth_version != depth_version || !may_change) return;
  if (answer.calibration) improve(*answer.calibration);
  if (answer.remeasured.empty()) return;
  const std::vector<MapPose> before = back_end.keyframePoses();
  follow({back_end.remeasure(answer.remeasured)}, before);
}

/// One step of what is known of the camera.
void Mapper::State::improve(const DepthCalibration& step) {
  last_calibration = textOf(step);
  DepthCalibration known = step;
  known.camera = camera.withoutDistortion();
  if (calibration) {
    known.name = calibration->name;
    known.field = calibration->field.then(step.field);
    known.before_mm = calibration->before_mm;
  }
  use(std::move(known));
  is_calibration_loaded = false;
  ++depth_version;
  correctDepthBy(step.field, step.left_per_m);
  back_end.countCorrection();
  closer_is_old = constraints_are_old = true;
}

/// Takes everything that depth has made to what it would be had it been corrected by more.
void Mapper::State::correctDepthBy(const DepthField& step, double left_per_m) {
  correctDepth(map, {step, frame.camera, back_end.graph().keyframes(), sensor, left_per_m});
  DepthCorrector views_corrector(step);
  for (KeyframeView& keyframe : views) {
    keyframe.depth_mm = views_corrector.likeInput(keyframe.depth_mm, kMillimetre);
  }
  localiser.correctDepth(step);
  showFrom({view.fragment, view.T_map_camera}, false);
  map_at_loss.reset();
  place_is_stale = true;
}

void Mapper::calibrate(const DepthCalibration& calibration) {
  State& s = *state_;
  if (!s.config.calibration.corrects()) {
    throw InputError(
        "calibration.mode is none, and a calibration is given: expected learn or "
        "frozen");
  }
  s.use(calibration);
}

const std::optional<DepthCalibration>& Mapper::calibration() const { return state_->calibration; }

int Mapper::depthVersion() const { return state_->depth_version; }

std::string Mapper::askForCalibration() {
  State& s = *state_;
  if (!s.config.calibration.learns()) {
    return "calibration.mode is " + s.config.calibration.mode + ", expected learn";
  }
  if (s.back_end.graph().keyframes().empty()) return "there is no map: nothing was mapped";
  s.calibration_is_asked = true;
  s.last_calibration.clear();
  return {};
}

const std::string& Mapper::lastCalibration() const { return state_->last_calibration; }

}  // namespace pf

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
DepthSensor Mapper::State::sensorWith(const std::optional<DepthCalibration>& known) const {
  DepthSensor result = depthSensorOf(config);
  if (!known || known->left_per_m <= 0) return result;
  result.systematic_1_m = std::min(result.systematic_1_m, static_cast<float>(known->left_per_m));
  return result;
}

void Mapper::State::use(std::optional<DepthCalibration> known) {
  const DepthField field = fieldOf(known);
  use(std::move(known), DepthCorrector(field), DepthCorrector(field.inverse()));
  is_calibration_loaded = calibration.has_value();
}

/// `there`, `back`: to corrected depth and from it.
void Mapper::State::use(std::optional<DepthCalibration> known, DepthCorrector there,
                        DepthCorrector back) {
  calibration = std::move(known);
  corrector = std::move(there);
  distorter = std::move(back);
  sensor = sensorWith(calibration);
}

void Mapper::State::take(const LoopAnswer& answer) {
  if (!answer.calibration_doubt.empty()) last_calibration = answer.calibration_doubt;
  // Of depth as it was before, nothing more is to be learned.
  if (answer.depth_version != depth_version) return;
  if (answer.calibration) wanted.depth = answer.calibration;
  if (!answer.remeasured.empty()) wanted.remeasured = answer.remeasured;
}

/// One more step, as it is to be prepared.
DepthImprovement Mapper::State::improvementBy(const DepthCalibration& learned) const {
  DepthImprovement depth;
  depth.learned = depth.known = learned;
  depth.known.camera = camera.withoutDistortion();
  if (calibration) {
    depth.known.name = calibration->name;
    depth.known.field = calibration->field.then(learned.field);
    depth.known.before_mm = calibration->before_mm;
  }
  depth.step = {learned.field, frame.camera, {}, sensorWith(depth.known), learned.left_per_m};
  depth.tracking = config.tracking;
  depth.frame_size = {camera.width, camera.height};
  depth.views = views;
  return depth;
}

/// All that depth has made follows one more step.
void Mapper::State::noteImproved(DepthImprovement& depth) {
  last_calibration = textOf(depth.learned);
  use(std::move(depth.known), std::move(depth.corrector), std::move(depth.distorter));
  is_calibration_loaded = false;
  ++depth_version;
  closer_is_old = true;
  wanted.depth.reset();  // of depth as it was before
  wanted.remeasured.clear();
}

/// All that depth has made was taken to what it would be had it been corrected by more.
void Mapper::State::depthHasChanged(DepthCorrector& step) {
  localiser.correctDepth(step);
  if (!wanted_view) showFrom({view.fragment, view.T_map_camera}, view.stamp_ns, false);
  wanted_view->fill = false;  // the frame was of depth as it was before
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

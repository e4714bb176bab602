// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/slam/pipeline.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <utility>

#include "posefusion/core/stopwatch.hpp"

namespace pf {
namespace {

/// What was freed goes back to the system. The refinement needs as much as mapping did, in blocks
/// of other sizes, which would come on top.
void giveBackFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace

Pipeline::Pipeline(const Config& config, std::unique_ptr<PoseDetector> detector)
    : config_(config),
      gate_(config.blur),
      color_(config.calibration),
      detector_(std::move(detector)),
      segmenter_(config.segmentation, depthSensorOf(config)),
      mapper_(config),
      loop_thread_(config, AnswerTime::after_lag) {}

std::string Pipeline::finish() {
  loop_thread_.finish(mapper_);
  if (!config_.loop.enabled || !config_.loop.refine_at_end) return {};
  giveBackFreedMemory();
  return mapper_.refine().text();
}

SeenFrame Pipeline::see(const RgbdFrame& frame) {
  SeenFrame seen;
  if (!defectOf(frame).empty()) {
    seen.frame = frame;
    return seen;
  }
  Stopwatch watch;
  seen.frame = rectifier_.rectify(frame);
  seen.blur = gate_.judge(measureSharpness(seen.frame.color), frame.stamp_ns);
  if (seen.blur.sharp) seen.frame = color_.registered(seen.frame);
  seen.gate_ms = watch.lapMs();
  seen.people.stamp_ns = frame.stamp_ns;
  if (!seen.blur.sharp) return seen;
  seen.people = detector_->detect(seen.frame);
  seen.pose_ms = watch.lapMs();
  flow_.advance(seen.frame);
  seen.flow = flow_.images();
  seen.flow_ms = watch.lapMs();
  return seen;
}

ProcessedFrame Pipeline::map(SeenFrame seen) {
  ProcessedFrame out;
  out.seen = std::move(seen);
  const RgbdFrame& frame = out.seen.frame;
  if (!defectOf(frame).empty() || !out.seen.blur.sharp) {
    out.status = mapper_.skip(
        frame.stamp_ns, out.seen.blur.sharp ? FrameOutcome::bad_input : FrameOutcome::blurred);
    out.status.detail = defectOf(frame);
    return out;
  }
  Stopwatch watch;
  const ModelView& view = mapper_.view();
  out.segmentation =
      segmenter_.segment(frame, out.seen.flow, out.seen.people, view.empty() ? nullptr : &view);
  out.segmentation_ms = watch.lapMs();
  StaticFrame still{frame, out.segmentation.mask, out.seen.flow.corners()};
  still.frame.depth = out.segmentation.static_depth;
  still.forced = out.seen.blur.forced;
  still.input_depth = frame.depth;
  robot_.playUntil(frame.stamp_ns, mapper_);
  out.status = mapper_.process(still);
  watch.lapMs();
  const double waited_before_ms = loop_thread_.waitedMs();
  loop_thread_.serve(mapper_);
  out.loop_wait_ms = loop_thread_.waitedMs() - waited_before_ms;
  out.loop_ms = watch.lapMs() - out.loop_wait_ms;
  mapper_.view();  // drawn here, so that the next frame finds it
  out.status.fusion_ms += watch.lapMs();
  return out;
}

}  // namespace pf

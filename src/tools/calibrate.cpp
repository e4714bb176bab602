// SPDX-License-Identifier: BSD-3-Clause
// posefusion_calibrate: the systematic error of a depth camera, from a map that it made or from a
// recording.
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "posefusion/calibration/field_estimate.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/calibration_views.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/loop/dense_pairs.hpp"
#include "posefusion/run/field_picture.hpp"
#include "posefusion/run/run.hpp"
#include "posefusion_ros/bags/bag_source.hpp"
#include "progress.hpp"
#include "tool.hpp"

namespace pf {
namespace {

struct Options {
  std::string input, output, name, picture, truth;
};

/// Error of depth (mm) that an error of 1/z makes at z metres.
double errorMm(double per_m, double z_m) { return 1000.0 * per_m * z_m * z_m; }

void printEstimate(const FieldEstimate& e) {
  std::printf("keyframes    %zu, %zu pairs, %zu residuals\n", e.views, e.pairs, e.residuals);
  if (e.pairs == 0 || e.kept_out.pairs == 0) return;
  std::printf("kept out     %zu pairs: median residual %.2f mm, with the field %.2f mm\n",
              e.kept_out.pairs, e.kept_out.before_mm, e.kept_out.after_mm);
  std::printf("             better by %.1f standard errors (loss %.4f, %.4f)\n",
              e.kept_out.significance, e.kept_out.before_loss, e.kept_out.after_loss);
  const double rms = e.field.rms();
  std::printf("field        RMS %.5f 1/m: %.1f mm at 1 m, %.1f at 2 m, %.1f at 4 m\n", rms,
              errorMm(rms, 1), errorMm(rms, 2), errorMm(rms, 4));
  std::printf("left         %.5f 1/m unexplained; field known to %.5f 1/m\n", e.rest_per_m,
              e.sigma_per_m);
}

void printTruth(const DepthField& field, const DepthField& truth) {
  const FieldComparison c = compare(field, truth);
  std::printf("truth        RMS %.5f 1/m about a mean of %.5f: %.1f mm at 4 m\n", c.rms_b, c.mean_b,
              errorMm(c.rms_b, 4));
  std::printf("             correlation %.3f; left %.5f 1/m: %.1f mm at 4 m\n", c.correlation,
              c.rms_difference, errorMm(c.rms_difference, 4));
}

bool isMap(const std::string& path) { return std::filesystem::path(path).extension() == ".pfdb"; }

/// Maps a recording, in memory, and learns of its camera on the way.
CalibrationViews viewsOfRecording(const Options& options) {
  const auto source = posefusion_ros::openInput(options.input, {});
  const Config config = configFor({}, *source);
  Pipeline pipeline(config, makePoseDetector(config.pose, {}));
  CalibrationViews all;
  std::size_t frames = 0;
  Progress progress(source->frameCount());
  runPipeline(*source, pipeline, [&](const ProcessedFrame& frame, const std::string& defect) {
    if (defect.empty() && defectOf(frame.seen.frame).empty()) all.camera = frame.seen.frame.camera;
    progress.update(++frames);
    return true;
  });
  pipeline.finish();
  const Mapper& mapper = pipeline.mapper();
  const std::vector<MapPose> poses = mapper.backEnd().keyframePoses();
  for (KeyframeView view : mapper.keyframeViews()) {
    view.pose = poses[static_cast<std::size_t>(view.id)];
    all.views.push_back(calibrationView(view, depthSensorOf(config)));
  }
  all.corrected_by = mapper.calibration();
  return all;
}

/// What depth is to be corrected by, all in all. Throws where nothing was found.
DepthCalibration calibrationBy(const CalibrationViews& seen, const FieldEstimate& estimate,
                               const Options& options) {
  DepthCalibration calibration = estimate.asCalibration();
  calibration.name = options.name;
  calibration.camera = seen.camera.withoutDistortion();
  if (!seen.corrected_by) {
    if (!estimate.worth_taking) throw InputError(options.input + ": " + estimate.reason);
    return calibration;
  }
  // Depth that was corrected already shows what that correction left.
  const std::string doubt = estimate.doubtOfStep(seen.corrected_by->pairs);
  if (doubt.empty()) {
    calibration.field = seen.corrected_by->field.then(estimate.field).centred();
    calibration.before_mm = seen.corrected_by->before_mm;
  } else {
    calibration = *seen.corrected_by;
    if (!options.name.empty()) calibration.name = options.name;
    std::printf("corrected    already by the calibration of the map, which stands: %s\n",
                doubt.c_str());
  }
  return calibration;
}

int calibrate(const Options& options) {
  const CalibrationViews seen =
      isMap(options.input) ? readCalibrationViews(options.input) : viewsOfRecording(options);
  FieldEstimateConfig config;
  config.known = fieldOf(seen.corrected_by);
  const FieldEstimate estimate = estimateField(seen.views, config);
  printEstimate(estimate);
  std::optional<DepthField> truth;
  if (!options.truth.empty()) truth = loadCalibration(options.truth + "/depth_field.yaml").field;
  const DepthCalibration calibration = calibrationBy(seen, estimate, options);
  std::printf("calibration  RMS %.1f mm at 2 m, %.1f at 4 m; pairs kept out: %.2f to %.2f mm\n",
              errorMm(calibration.field.rms(), 2), errorMm(calibration.field.rms(), 4),
              calibration.before_mm, calibration.after_mm);
  if (truth) printTruth(calibration.field, *truth);
  if (!options.picture.empty()) savePng(options.picture, drawFields(calibration.field, truth));
  saveCalibration(options.output, calibration);
  std::printf("written      %s\n", options.output.c_str());
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{
      "Estimates the smooth systematic error of a depth camera from a map or a recording.",
      "posefusion_calibrate"};
  pf::Options options;
  app.addOption("input", options.input,
                "map file (*.pfdb), or a recording (TUM folder or bag), which is mapped for it")
      ->required();
  app.addOption("-o,--output", options.output, "calibration file to write")->required();
  app.addOption("--name", options.name, "of the camera: serial number, or what you call it");
  app.addOption("--picture", options.picture, "PNG of the field");
  app.addOption("--truth", options.truth,
                "folder of the simulated recording: how far from the true field");
  return pf::runTool(app, argc, argv, [&] { return pf::calibrate(options); });
}

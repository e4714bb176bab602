// SPDX-License-Identifier: BSD-3-Clause
// posefusion_calibrate: the systematic error of a depth camera, from a map that it made.
#include <cstdio>
#include <optional>
#include <string>

#include "posefusion/calibration/field_estimate.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/calibration_file.hpp"
#include "posefusion/io/calibration_views.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/run/field_picture.hpp"
#include "tool.hpp"

namespace pf {
namespace {

struct Options {
  std::string map, output, name, picture, truth;
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

int calibrate(const Options& options) {
  const CalibrationViews recorded = readCalibrationViews(options.map);
  const FieldEstimate estimate = estimateField(recorded.views);
  printEstimate(estimate);
  // A map whose depth was corrected already tells what that correction left.
  DepthField field = estimate.field;
  if (recorded.corrected_by) field = recorded.corrected_by->field.then(field).centred();
  std::optional<DepthField> truth;
  if (!options.truth.empty()) truth = loadCalibration(options.truth + "/depth_field.yaml").field;
  if (truth) printTruth(field, *truth);
  if (!options.picture.empty()) savePng(options.picture, drawFields(field, truth));
  if (!estimate.worth_taking) throw InputError(options.map + ": " + estimate.reason);
  saveCalibration(options.output, {options.name, recorded.camera.withoutDistortion(), field,
                                   estimate.views, estimate.pairs, estimate.kept_out.before_mm,
                                   estimate.kept_out.after_mm, estimate.left_per_m()});
  std::printf("calibration  %s\n", options.output.c_str());
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  CLI::App app{"Estimates the smooth systematic error of a depth camera from a map that it made.",
               "posefusion_calibrate"};
  pf::Options options;
  app.add_option("map", options.map, "map file (*.pfdb), its loops closed")->required();
  app.add_option("-o,--output", options.output, "calibration file to write")->required();
  app.add_option("--name", options.name, "of the camera: serial number, or what you call it");
  app.add_option("--picture", options.picture, "PNG of the field");
  app.add_option("--truth", options.truth,
                 "folder of the simulated recording: how far from the true field");
  return pf::runTool(app, argc, argv, [&] { return pf::calibrate(options); });
}

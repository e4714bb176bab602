// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/field_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "field_solver.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

// One chance in a thousand that luck alone does as well.
constexpr double kSignificant = 3.1;
// One in twenty: pairs that agree worse by no more than that do not speak against a field, and
// better by no more, not for one.
constexpr double kLikely = 1.64;
// An estimate from so many times the pairs is better by itself: its variance falls with them. For
// less the map is not moved.
constexpr double kMore = 1.25;
// The covariance knows of what differs between views alone: fields of simulated cameras were off by
// two to three and a half times of it. Of many pairs the tiniest gain is no luck: what is taken out
// must be clearly more than what may be put in, or a good camera would be made no better, or worse.
constexpr double kSigmas = 3.0;
constexpr char kNoBetter[] =
    "pairs that were kept out do not agree better by more than luck explains";
// One judging pair alone has no standard error.
constexpr std::size_t kFewestJudges = 2;

void require(const CalibrationView& view) {
  const std::string name = "keyframe " + std::to_string(view.id) + ": ";
  if (view.depth_mm.type() != CV_16UC1) throw InputError(name + "depth is not 16 bits, in mm");
  if (view.depth_mm.cols == view.camera.width && view.depth_mm.rows == view.camera.height) return;
  throw InputError(name + "depth is " + std::to_string(view.depth_mm.cols) + " x " +
                   std::to_string(view.depth_mm.rows) + ", expected the camera's " +
                   std::to_string(view.camera.width) + " x " + std::to_string(view.camera.height));
}

/// In the order of their numbers, so that the order they came in does not matter.
std::vector<ViewSurface> surfacesOf(const std::vector<CalibrationView>& views) {
  std::vector<const CalibrationView*> sorted;
  for (const CalibrationView& view : views) {
    require(view);
    sorted.push_back(&view);
  }
  std::sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return a->id < b->id; });
  std::vector<std::vector<ViewSurface>> made(sorted.size());
  parallelFor(sorted.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) made[i].emplace_back(*sorted[i]);
  });
  std::vector<ViewSurface> surfaces;
  for (auto& one : made) surfaces.push_back(std::move(one.front()));
  return surfaces;
}

/// Standard deviation of the field, RMS over the image.
double sigmaOf(const DepthField& field, const Eigen::MatrixXd& covariance) {
  constexpr int kAcross = 32, kDown = 24;
  double sum = 0;
  for (int i = 0; i < kAcross * kDown; ++i) {
    const FieldWeights w =
        field.weights((i % kAcross + 0.5) / kAcross, (i / kAcross + 0.5) / kDown);
    for (int a = 0; a < FieldWeights::kNodes; ++a) {
      for (int b = 0; b < FieldWeights::kNodes; ++b) {
        sum += w.weight(a) * w.weight(b) * covariance(w.node(a), w.node(b));
      }
    }
  }
  return std::sqrt(sum / (kAcross * kDown));
}

std::string doubtOf(const FieldEstimate& estimate) {
  if (estimate.kept_out.significance <= kSignificant) return kNoBetter;
  const double rms = estimate.field.rms();
  if (rms > estimate.left_per_m()) return {};
  std::ostringstream text;
  text << "the error found, " << rms << " 1/m, is less than " << kSigmas
       << " times what it is known to, " << estimate.sigma_per_m;
  return text.str();
}

}  // namespace

std::string FieldEstimate::doubtOfStep(std::size_t known_from_pairs) const {
  if (kept_out.pairs == 0) return reason;
  if (kept_out.significance > kSignificant) return {};
  const bool knows_more = known_from_pairs > 0 && static_cast<double>(pairs) >
                                                      kMore * static_cast<double>(known_from_pairs);
  if (knows_more && kept_out.significance > -kLikely) return {};
  return kNoBetter;
}

std::string FieldEstimate::doubtBeside(const std::optional<DepthCalibration>& known) const {
  return known ? doubtOfStep(known->pairs) : reason;
}

bool FieldEstimate::clears(const DepthSensor& sensor) const {
  return kept_out.pairs > 0 && kept_out.significance <= kLikely &&
         left_per_m() < sensor.systematic_1_m;
}

DepthCalibration FieldEstimate::asCalibration() const {
  DepthCalibration step;
  step.field = field;
  step.keyframes = views;
  step.pairs = pairs;
  step.before_mm = kept_out.before_mm;
  step.after_mm = kept_out.after_mm;
  step.left_per_m = left_per_m();
  return step;
}

double FieldEstimate::left_per_m() const { return kSigmas * sigma_per_m; }

FieldEstimate estimateField(const std::vector<CalibrationView>& views,
                            const FieldEstimateConfig& config) {
  return estimateFieldFrom(surfacesOf(views), config);
}

FieldEstimate estimateFieldFrom(const std::vector<ViewSurface>& surfaces,
                                const FieldEstimateConfig& config) {
  FieldEstimate estimate;
  estimate.field = DepthField(config.columns, config.rows);
  estimate.views = surfaces.size();
  std::vector<ViewPair> learned, judges;
  for (const ViewPair& pair : overlappingPairs(surfaces, config.pairs)) {
    const bool judge =
        (learned.size() + judges.size()) % config.keep_out_every == config.keep_out_every - 1;
    (judge ? judges : learned).push_back(pair);
  }
  estimate.pairs = learned.size();
  if (judges.size() < kFewestJudges) {
    estimate.reason = "of " + std::to_string(surfaces.size()) + " keyframes " +
                      std::to_string(learned.size() + judges.size()) +
                      " pairs saw the same surface, expected " +
                      std::to_string(kFewestJudges * config.keep_out_every) + " or more";
    return estimate;
  }
  FieldSolution solution = solveField(std::move(learned), surfaces, config);
  estimate.field = std::move(solution.field);
  estimate.covariance = std::move(solution.covariance);
  estimate.sigma_per_m = sigmaOf(estimate.field, estimate.covariance);
  estimate.residuals = solution.residuals;
  estimate.rest_per_m = solution.model.rest_per_m;
  estimate.kept_out = judgeField(judges, surfaces, estimate.field, solution.model);
  estimate.reason = doubtOf(estimate);
  estimate.worth_taking = estimate.reason.empty();
  return estimate;
}

}  // namespace pf

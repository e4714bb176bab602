// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/verify.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace pf {
namespace {

// Rounds of drawing and aligning: the grid's pose may be 10 cm and 5 degrees off, from where the
// map shows other things than from the right one.
constexpr int kRounds = 3;
constexpr double kSettled_m = 0.01, kSettled_rad = 0.01;
constexpr double kSamePlace_m = 0.1, kSamePlace_rad = 0.06;
// Of two places that look alike one is believed by odds of 150 to 1: so much more chi-square.
constexpr double kTellsApart = 10.0;
constexpr float kAgreeingSigmas = 4.0F;
constexpr float kMinNormalCosine = 0.7F;
// Grey levels are compared in windows of so many pixels: light and exposure change slowly.
constexpr int kWindow = 16;
constexpr double kLeastPixels = 0.3;     // of a window
constexpr double kLeastVariance = 40.0;  // of grey levels: less texture tells nothing
// Nothing is known before: a prior as wide as the gates.
constexpr double kPriorShift_m = 0.3, kPriorTurn_rad = 0.3;

/// Sums over a window, for the correlation.
struct GreySums {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;

  void add(double x, double y) { n += 1, a += x, b += y, aa += x * x, bb += y * y, ab += x * y; }
};

/// The windows' correlations, weighted by their texture; 0 where there is none.
double correlationOf(const std::vector<GreySums>& windows) {
  double both = 0, texture = 0;
  for (const GreySums& w : windows) {
    if (w.n < kLeastPixels * kWindow * kWindow) continue;
    const double va = w.aa / w.n - w.a * w.a / (w.n * w.n);
    const double vb = w.bb / w.n - w.b * w.b / (w.n * w.n);
    if (std::max(va, vb) < kLeastVariance) continue;
    const double root = std::sqrt(std::max(0.0, va * vb));
    both += w.ab / w.n - w.a * w.b / (w.n * w.n);
    texture += std::max(root, 0.5 * std::max(va, vb));
  }
  return texture > 0 ? both / texture : 0.0;
}

/// Pixels, and the sum of the outer products of the normals of those that agree.
struct Counts {
  double valid = 0, known = 0, agreeing = 0, through = 0, hidden = 0;
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
};

/// One row; `windows` are those that it crosses.
void compareRow(const WorkingFrame& frame, const ModelView& view, int v, GreySums* windows,
                Counts& counts) {
  const FrameLevel& level = frame.levels[0];
  const DepthSensor sensor = frame.sensor;
  const auto *seen = level.depth_m.ptr<float>(v), *model = view.depth_m.ptr<float>(v);
  const auto *ax = level.normal_x.ptr<float>(v), *ay = level.normal_y.ptr<float>(v);
  const auto *az = level.normal_z.ptr<float>(v), *bx = view.normal_x.ptr<float>(v);
  const auto *by = view.normal_y.ptr<float>(v), *bz = view.normal_z.ptr<float>(v);
  const auto *grey = level.intensity.ptr<float>(v), *mapped = view.intensity.ptr<float>(v);
  const auto* still = level.still.ptr<std::uint8_t>(v);
  Eigen::Matrix3f normals = Eigen::Matrix3f::Zero();
  for (int u = 0; u < level.depth_m.cols; ++u) {
    if (seen[u] <= 0) continue;
    ++counts.valid;
    if (model[u] <= 0) continue;
    ++counts.known;
    const float nz = std::min(-0.2F, bz[u]);
    const float tolerance = sensor.tolerance(std::max(seen[u], model[u]), kAgreeingSigmas) / -nz;
    if (seen[u] > model[u] + tolerance) ++counts.through;
    if (seen[u] < model[u] - tolerance) ++counts.hidden;
    if (std::abs(seen[u] - model[u]) > tolerance) continue;
    const float cosine = ax[u] * bx[u] + ay[u] * by[u] + az[u] * bz[u];
    if (az[u] < 0 && cosine < kMinNormalCosine) continue;
    ++counts.agreeing;
    const Eigen::Vector3f n(bx[u], by[u], bz[u]);
    normals += n * n.transpose();
    if (still[u] != 0) windows[u / kWindow].add(grey[u], mapped[u]);
  }
  counts.normals += normals.cast<double>();
}

bool isSamePlace(const PlaceVerdict& a, const PlaceVerdict& b) {
  const Eigen::Isometry3d step = a.alignment.T_map_camera.inverse() * b.alignment.T_map_camera;
  return a.fragment == b.fragment && isWithin(step, kSamePlace_m, kSamePlace_rad);
}

/// Of places that all look right (at least one) that where dead reckoning expects the camera, if by
/// far; else the best one, as ambiguous.
PlaceVerdict likeliest(std::vector<PlaceVerdict>& places, const ExpectedPlace* expected) {
  if (places.size() == 1) return places.front();
  const auto surprise = [&](const PlaceVerdict& place) {
    return expected == nullptr ? 0.0 : expected->chiSquare(place.pose());
  };
  std::stable_sort(places.begin(), places.end(),
                   [&](const auto& a, const auto& b) { return surprise(a) < surprise(b); });
  if (surprise(places[1]) - surprise(places[0]) < kTellsApart) {
    places[0].doubt = PlaceDoubt::ambiguous;
  }
  return places[0];
}

}  // namespace

std::string_view name(PlaceDoubt doubt) {
  constexpr std::array<std::string_view, kPlaceDoubts> kNames = {
      "none",       "covered",   "little_overlap", "not_converged", "degenerate",
      "moved_away", "disagrees", "seen_through",   "other_picture", "ambiguous"};
  return kNames.at(static_cast<std::size_t>(doubt));
}

PlaceAgreement compareViews(const WorkingFrame& frame, const ModelView& view) {
  const FrameLevel& level = frame.levels[0];
  const int across = (level.depth_m.cols + kWindow - 1) / kWindow;
  const int down = (level.depth_m.rows + kWindow - 1) / kWindow;
  std::vector<GreySums> windows(static_cast<std::size_t>(across * down));
  Counts counts;
  for (int v = 0; v < level.depth_m.rows; ++v) {
    compareRow(frame, view, v, &windows[static_cast<std::size_t>(v / kWindow * across)], counts);
  }
  PlaceAgreement result;
  result.view = counts.valid / static_cast<double>(level.depth_m.total());
  result.overlap = counts.known / std::max(1.0, counts.valid);
  result.agreeing = counts.agreeing / std::max(1.0, counts.known);
  result.seen_through = counts.through / std::max(1.0, counts.known);
  result.hidden = counts.hidden / std::max(1.0, counts.known);
  result.correlation = correlationOf(windows);
  result.spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(counts.normals /
                                                                 std::max(1.0, counts.agreeing))
                      .eigenvalues()[0];
  return result;
}

TrackingStart freeStart(const Eigen::Isometry3d& T_map_camera) {
  TrackingStart start;
  start.T_map_view = start.T_map_camera = start.prior.T_map_camera = T_map_camera;
  start.prior.covariance = independentCovariance(kPriorShift_m, kPriorTurn_rad);
  return start;
}

double positionSigma(const Matrix6d& covariance) {
  const Eigen::Matrix3d of_shift = covariance.topLeftCorner<3, 3>();
  return std::sqrt(
      std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(of_shift).eigenvalues()[2]));
}

bool hasShape(const PlaceAgreement& agreement, const VerifyLimits& limits) {
  return agreement.overlap >= limits.shape_overlap && agreement.spread >= limits.shape_spread;
}

PlaceDoubt judgePlace(const PlaceVerdict& v, const Eigen::Isometry3d& T_map_candidate,
                      const VerifyLimits& limits) {
  const Eigen::Isometry3d step = T_map_candidate.inverse() * v.alignment.T_map_camera;
  if (v.agreement.view < limits.min_view) return PlaceDoubt::covered;
  if (v.agreement.overlap < limits.min_overlap) return PlaceDoubt::little_overlap;
  if (!v.alignment.converged) return PlaceDoubt::not_converged;
  // Somebody or something new before the map does not speak against the place, up to a point.
  const double visible = 1.0 - v.agreement.hidden;
  const bool both = v.agreement.spread >= limits.shape_of_both &&
                    v.agreement.correlation >= limits.correlation_of_both;
  const double least_agreeing = both ? limits.min_agreeing_of_both : limits.min_agreeing;
  if (v.agreement.hidden > limits.max_hidden || v.agreement.agreeing < least_agreeing * visible) {
    return PlaceDoubt::disagrees;
  }
  if (v.agreement.seen_through > limits.max_seen_through) return PlaceDoubt::seen_through;
  const double least =
      hasShape(v.agreement, limits) ? limits.min_correlation_of_shape : limits.min_correlation;
  if (v.agreement.correlation < least) return PlaceDoubt::other_picture;
  if (v.alignment.free_directions > 0 ||
      positionSigma(v.alignment.covariance) > limits.max_sigma_m) {
    return PlaceDoubt::degenerate;
  }
  if (!isWithin(step, limits.max_shift_m, limits.max_turn_rad)) {
    return PlaceDoubt::moved_away;
  }
  return PlaceDoubt::none;
}

PlaceAgreement PlaceVerifier::compare(const SurfelMap& map, const WorkingFrame& frame,
                                      const MapPose& pose) {
  RenderOptions options;
  options.age = SurfelAge::all;
  options.fragment = pose.fragment;
  renderer_.render(map, frame.camera, pose.T_map_camera, options, view_);
  return compareViews(frame, view_);
}

PlaceVerdict PlaceVerifier::verify(const SurfelMap& map, const WorkingFrame& frame,
                                   const MapPose& candidate) {
  RenderOptions options;
  options.age = SurfelAge::all;
  options.fragment = candidate.fragment;
  PlaceVerdict verdict;
  verdict.fragment = candidate.fragment;
  verdict.alignment.T_map_camera = candidate.T_map_camera;
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Isometry3d T = verdict.alignment.T_map_camera;
    renderer_.render(map, frame.camera, T, options, view_);
    model_.assign(view_, frame.sensor);
    TrackingStart start = freeStart(T);
    start.brightness = verdict.alignment.brightness;
    verdict.alignment = track(frame, model_, start, tracking_);
    const Eigen::Isometry3d step = T.inverse() * verdict.alignment.T_map_camera;
    if (!verdict.alignment.converged && i > 0) break;
    if (step.translation().norm() < kSettled_m && angleOf(step) < kSettled_rad) break;
  }
  verdict.agreement = compare(map, frame, verdict.pose());
  verdict.doubt = judgePlace(verdict, candidate.T_map_camera, limits_);
  return verdict;
}

PlaceVerdict PlaceVerifier::verifyBest(const SurfelMap& map, const WorkingFrame& frame,
                                       const std::vector<PlaceCandidate>& candidates,
                                       std::size_t most, const ExpectedPlace* expected) {
  PlaceVerdict first;
  std::vector<PlaceVerdict> places;  // believed, the best of each
  for (std::size_t i = 0; i < std::min(most, candidates.size()); ++i) {
    const PlaceVerdict verdict = verify(map, frame, candidates[i].pose);
    if (i == 0) first = verdict;
    if (!verdict.accepted()) continue;
    const auto same = std::find_if(places.begin(), places.end(),
                                   [&](const auto& p) { return isSamePlace(p, verdict); });
    if (same == places.end()) {
      places.push_back(verdict);
    } else if (verdict.score() > same->score()) {
      *same = verdict;
    }
    if (places.size() > 1 && expected == nullptr) break;
  }
  if (places.empty()) return first;
  return likeliest(places, expected);
}

}  // namespace pf

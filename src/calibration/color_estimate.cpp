// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/calibration/color_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <utility>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

constexpr std::size_t kLeastSteps = 50;
constexpr std::size_t kLeastViews = 8;  // that judge or are learned from
// Where the search begins: zoom by so many steps, shift right and down (parts of the width). It
// ends within twice that.
constexpr int kZooms = 7, kShifts = 6;
constexpr double kZoomStep = 0.02, kShiftStep = 0.00625;
constexpr std::size_t kCoarse = 16;  // one step in so many tells where
constexpr double kFinest_px = 0.1;
// As for the field of depth: one chance in a thousand, and three times what it is known to.
constexpr double kSureGain = 3.1, kKnown = 3.0;
// At steps of depth colour is as much of an edge as elsewhere where the two have nothing to do with
// each other (1.04), and 1.4 times as much or more where they do.
constexpr double kLeastContrast = 1.2, kAround = 0.025;  // of the width
// Beside near things, where the light of a projector does not reach, steps of depth are themselves
// off by as much.
constexpr double kWorth = 3.0 / 640.0;  // of the width

/// Zoom, shift right and down (parts of the width), and to the right at 1 m.
using Offsets = std::array<double, 4>;

ColorCamera cameraOf(const Offsets& o, const PinholeCamera& depth) {
  const double zoom = 1.0 + o[0];
  return {zoom * depth.fx, zoom * depth.fy, depth.cx + o[1] * depth.width,
          depth.cy + o[2] * depth.width, o[3] * depth.width / (zoom * depth.fx)};
}

bool isBeyond(const Offsets& o) {
  return std::abs(o[0]) > 2 * kZooms * kZoomStep ||
         std::any_of(o.begin() + 1, o.end(),
                     [](double shift) { return std::abs(shift) > 2 * kShifts * kShiftStep; });
}

/// Mean strength at the steps of a view, 0 to 255; one that is outside counts as any pixel.
double strengthAt(const EdgeView& view, const PinholeCamera& depth, const ColorCamera& camera,
                  std::size_t every) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < view.size(); i += every, ++count) {
    const Eigen::Vector2d p = camera.pixel(depth, view.x[i], view.y[i], view.inverse[i]);
    const int u = static_cast<int>(std::floor(p.x())), v = static_cast<int>(std::floor(p.y()));
    if (u < 0 || v < 0 || u + 1 >= view.strength.cols || v + 1 >= view.strength.rows) {
      sum += view.mean_strength;
      continue;
    }
    const double a = p.x() - u, b = p.y() - v;
    const auto *upper = view.strength.ptr<std::uint8_t>(v) + u,
               *lower = view.strength.ptr<std::uint8_t>(v + 1) + u;
    sum += (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
  }
  return count > 0 ? sum / static_cast<double>(count) : view.mean_strength;
}

/// From view `begin` to before `end`.
std::vector<const EdgeView*> part(const std::vector<EdgeView>& views, std::size_t begin,
                                  std::size_t end) {
  std::vector<const EdgeView*> some;
  for (std::size_t i = begin; i < end; ++i) some.push_back(&views[i]);
  return some;
}

/// Looks for the offsets with the most strength.
class OffsetSearch {
 public:
  OffsetSearch(std::vector<const EdgeView*> views, const PinholeCamera& depth)
      : views_(std::move(views)), depth_(depth) {}

  Offsets find() const {
    Offsets best = coarse();
    Offsets step = {kZoomStep, kShiftStep, kShiftStep, kShiftStep};
    double most = score(best, 1);
    while (step[1] * depth_.width > kFinest_px) {
      if (!improve(step, best, most)) {
        for (double& s : step) s *= 0.5;
      }
    }
    return best;
  }

 private:
  double score(const Offsets& offsets, std::size_t every) const {
    const ColorCamera camera = cameraOf(offsets, depth_);
    double sum = 0;
    for (const EdgeView* view : views_) sum += strengthAt(*view, depth_, camera, every);
    return sum;
  }

  Offsets coarse() const {
    std::vector<Offsets> all;
    for (int zoom = -kZooms; zoom <= kZooms; ++zoom) {
      for (int right = -kShifts; right <= kShifts; ++right) {
        for (int down = -kShifts; down <= kShifts; ++down) {
          all.push_back({zoom * kZoomStep, right * kShiftStep, down * kShiftStep, 0.0});
        }
      }
    }
    std::vector<double> scores(all.size());
    parallelFor(all.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) scores[i] = score(all[i], kCoarse);
    });
    const auto best = std::max_element(scores.begin(), scores.end());
    return all[static_cast<std::size_t>(best - scores.begin())];
  }

  /// One step in each direction; a shift may be traded for one that falls with depth.
  bool improve(const Offsets& step, Offsets& best, double& most) const {
    std::vector<Offsets> tried;
    for (const double sign : {1.0, -1.0}) {
      for (std::size_t k = 0; k < step.size(); ++k) {
        tried.push_back(best);
        tried.back()[k] += sign * step[k];
      }
      tried.push_back(best);
      tried.back()[1] += sign * step[1];
      tried.back()[3] -= 2.0 * sign * step[3];
    }
    tried.erase(std::remove_if(tried.begin(), tried.end(), isBeyond), tried.end());
    std::vector<double> scores(tried.size());
    parallelFor(tried.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) scores[i] = score(tried[i], 1);
    });
    const auto top = std::max_element(scores.begin(), scores.end());
    if (top == scores.end() || !(*top > most)) return false;
    most = *top;
    best = tried[static_cast<std::size_t>(top - scores.begin())];
    return true;
  }

  std::vector<const EdgeView*> views_;
  PinholeCamera depth_;
};

/// How far two cameras see the steps from each other, RMS (pixels).
double apart(const std::vector<EdgeView>& views, const PinholeCamera& depth, const ColorCamera& a,
             const ColorCamera& b) {
  double sum = 0, count = 0;
  for (const EdgeView& view : views) {
    for (std::size_t i = 0; i < view.size(); ++i, ++count) {
      sum += (a.pixel(depth, view.x[i], view.y[i], view.inverse[i]) -
              b.pixel(depth, view.x[i], view.y[i], view.inverse[i]))
                 .squaredNorm();
    }
  }
  return std::sqrt(sum / std::max(1.0, count));
}

/// The gain of `camera` in views that it was not learned from, over its standard error.
double gainOf(const std::vector<const EdgeView*>& views, const PinholeCamera& depth,
              const ColorCamera& camera) {
  double sum = 0, squares = 0;
  for (const EdgeView* view : views) {
    const double gain =
        strengthAt(*view, depth, camera, 1) - strengthAt(*view, depth, registeredTo(depth), 1);
    sum += gain;
    squares += gain * gain;
  }
  const auto n = static_cast<double>(views.size());
  const double mean = sum / n;
  return mean / std::sqrt(std::max(1e-12, (squares / n - mean * mean) / (n - 1)));
}

/// How much more of an edge is where the steps are than around them.
double contrastOf(const std::vector<EdgeView>& views, const PinholeCamera& depth,
                  const ColorCamera& camera) {
  ColorCamera aside[4] = {camera, camera, camera, camera};
  aside[0].cx -= kAround * depth.width;
  aside[1].cx += kAround * depth.width;
  aside[2].cy -= kAround * depth.width;
  aside[3].cy += kAround * depth.width;
  double there = 0, around = 0;
  for (const EdgeView& view : views) {
    there += strengthAt(view, depth, camera, 1);
    for (const ColorCamera& c : aside) around += 0.25 * strengthAt(view, depth, c, 1);
  }
  return around > 0 ? there / around : 1.0;
}

std::string doubtOf(const ColorEstimate& e, const PinholeCamera& depth) {
  char text[160];
  if (e.contrast < kLeastContrast) {
    std::snprintf(text, sizeof(text),
                  "steps of depth are %.2f times as much of an edge as what is around them, "
                  "expected %.2f or more",
                  e.contrast, kLeastContrast);
  } else if (e.offset_px < kWorth * depth.width) {
    std::snprintf(text, sizeof(text), "colour lies over depth to %.1f px", e.offset_px);
  } else if (e.significance < kSureGain) {
    std::snprintf(text, sizeof(text),
                  "views that were kept out gain %.1f standard errors, expected %.1f or more",
                  e.significance, kSureGain);
  } else if (e.offset_px < kKnown * e.unknown_px) {
    std::snprintf(text, sizeof(text), "the offset of %.1f px is known to %.1f px only", e.offset_px,
                  e.unknown_px);
  } else {
    return {};
  }
  return text;
}

}  // namespace

ColorEstimate estimateColorCamera(const std::vector<EdgeView>& views, const PinholeCamera& depth) {
  ColorEstimate estimate;
  estimate.camera = registeredTo(depth);
  std::vector<EdgeView> used;
  std::copy_if(views.begin(), views.end(), std::back_inserter(used),
               [](const EdgeView& view) { return view.size() >= kLeastSteps; });
  if (used.size() < 2 * kLeastViews) {
    estimate.doubt = std::to_string(used.size()) + " views have steps of depth, expected " +
                     std::to_string(2 * kLeastViews) + " or more";
    return estimate;
  }
  const std::size_t half = used.size() / 2;
  const auto first = part(used, 0, half), second = part(used, half, used.size());
  const ColorCamera by_first = cameraOf(OffsetSearch(first, depth).find(), depth);
  const ColorCamera by_second = cameraOf(OffsetSearch(second, depth).find(), depth);
  estimate.camera = cameraOf(OffsetSearch(part(used, 0, used.size()), depth).find(), depth);
  estimate.offset_px = apart(used, depth, estimate.camera, registeredTo(depth));
  estimate.unknown_px = 0.5 * apart(used, depth, by_first, by_second);
  estimate.significance =
      std::min(gainOf(first, depth, by_second), gainOf(second, depth, by_first));
  estimate.contrast = contrastOf(used, depth, estimate.camera);
  estimate.doubt = doubtOf(estimate, depth);
  return estimate;
}

}  // namespace pf

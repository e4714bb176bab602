// SPDX-License-Identifier: BSD-3-Clause
#include "heading_scores.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"

namespace pf {
namespace {

// A correct pose and a wrong one may both look grey: the correlation counts half of the shape.
constexpr float kGreyShare = 0.5F;
constexpr float kLeastSpread = 30.0F;  // variance of grey levels below which they are not used
constexpr double kLeastFacing = 0.2;

/// Sums of one pixel for all headings.
struct Sums {
  float *known, *agreeing, *difference, *m, *mm, *q, *qq, *mq;
};

POSEFUSION_SIMD_CLONES
void addPixel(const float* range, const float* grey, float seen, float inverse_tolerance, float q,
              int headings, const Sums& s) {
  for (int h = 0; h < headings; ++h) {
    const float known = range[h] < 0.5F * kUnknownRange ? 1.0F : 0.0F;
    const float off = std::min(1.0F, std::abs(range[h] - seen) * inverse_tolerance);
    const float agrees = off < 1.0F ? 1.0F : 0.0F;
    const float g = grey[h];
    s.known[h] += known;
    s.difference[h] += known * off * off;
    s.agreeing[h] += agrees;
    s.m[h] += agrees * g;
    s.mm[h] += agrees * g * g;
    s.q[h] += agrees * q;
    s.qq[h] += agrees * q * q;
    s.mq[h] += agrees * g * q;
  }
}

}  // namespace

void HeadingScores::compute(const Panorama& panorama, const QueryRays& rays, int headings) {
  const auto count = static_cast<std::size_t>(headings);
  for (auto* array :
       {&known, &agreeing, &difference, &score, &correlation, &m_, &mm_, &q_, &qq_, &mq_}) {
    array->assign(count, 0.0F);
  }
  const Sums sums{known.data(), agreeing.data(), difference.data(), m_.data(),
                  mm_.data(),   q_.data(),       qq_.data(),        mq_.data()};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    addPixel(panorama.range(rays.row[i], rays.column[i]),
             panorama.intensity(rays.row[i], rays.column[i]), rays.range[i],
             rays.inverse_tolerance[i], rays.intensity[i], headings, sums);
  }
  const float all = 1.0F / static_cast<float>(std::max<std::size_t>(1, rays.size()));
  for (std::size_t h = 0; h < count; ++h) {
    const float n = std::max(1.0F, agreeing[h]);
    const float model = mm_[h] / n - (m_[h] / n) * (m_[h] / n);
    const float frame = qq_[h] / n - (q_[h] / n) * (q_[h] / n);
    const float both = mq_[h] / n - (m_[h] / n) * (q_[h] / n);
    if (model > kLeastSpread && frame > kLeastSpread) {
      correlation[h] = both / std::sqrt(model * frame);
    }
    score[h] = all * (known[h] - 2.0F * difference[h] + kGreyShare * agreeing[h] * correlation[h]);
  }
}

QueryRays raysOf(const PlaceQuery& query, const Eigen::Matrix3d& R, const PanoramaShape& shape,
                 double step_m, int every) {
  QueryRays rays;
  const double bin = shape.bin_rad();
  for (int v = 0; v < query.depth_m.rows; v += every) {
    for (int u = 0; u < query.depth_m.cols; u += every) {
      const float depth = query.depth_m.at<float>(v, u);
      if (depth <= 0) continue;
      const Eigen::Vector3d p = R * query.camera.unproject(u, v, depth);
      const double range = p.norm();
      if (range > shape.max_range_m) continue;
      const double elevation = std::asin(p.z() / range), azimuth = std::atan2(p.y(), p.x());
      rays.row.push_back(static_cast<int>(std::floor(elevation / bin)));
      rays.column.push_back(
          std::min(shape.columns() - 1, static_cast<int>(std::floor((azimuth + M_PI) / bin))));
      rays.range.push_back(static_cast<float>(range));
      // Along the ray a leaning surface is off by more than across it, within a bin most of all.
      const double cosine = std::max<double>(kLeastFacing, query.facing.at<float>(v, u));
      const double across = 0.5 * step_m + 0.5 * bin * range * std::sqrt(1.0 - cosine * cosine) +
                            3.0 * query.sensor.sigma(depth);
      rays.inverse_tolerance.push_back(static_cast<float>(cosine / across));
      rays.intensity.push_back(query.intensity.at<float>(v, u));
    }
  }
  return rays;
}

}  // namespace pf

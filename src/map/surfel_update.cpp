// SPDX-License-Identifier: BSD-3-Clause
#include "surfel_update.hpp"

#include <algorithm>
#include <cmath>

#include "measurement.hpp"
#include "posefusion/map/layers.hpp"

namespace pf {
namespace {

// A far measurement is near enough to both layers, and would keep both. What was made so much
// earlier was made in another pass; within one, surfels as far apart are an edge.
constexpr double kAnotherPass_s = 10.0 / 3.0;
// A person found now may have been in view, and mapped, for this long; such surfels must be removed
// before they are older.
constexpr double kUnnoticed_s = 1.5;
constexpr float kUnnoticedFrames = 2;  // of contradiction, a frame
// Seen well behind, in all of 3x3 pixels: surer than a view that agrees, which may be of something
// else at that depth.
constexpr float kSeenThroughFrames = 2;
// Nothing measured and another colour: hidden by something too near, or gone. Two seconds of a
// person in the way must not remove what was seen for one.
constexpr float kOtherFrames = 1.0F / 6.0F;
// A surfel whose plane leans further than this is not updated: its depth on the ray means little.
constexpr float kMinCosine = 0.2F;
// Grey levels, in any channel: more than three standard deviations of `tracking.photometric_sigma`.
constexpr float kOtherColor = 40.0F;
// A disc explains the pixels whose rays meet it well inside, and no more than a few.
constexpr float kExplainedShare = 0.9F, kMostExplained_px = 6.0F;

}  // namespace

SurfelUpdate::SurfelUpdate(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
                           const FusionOptions& options, const SurfelMap& map, Evidence& evidence)
    : frame_(frame),
      options_(options),
      map_(map),
      evidence_(evidence),
      projection_(frame.camera, T_map_camera),
      to_camera_(T_map_camera.inverse()),
      to_map_(T_map_camera),
      min_cosine_(static_cast<float>(std::cos(map.config().max_normal_angle_rad))),
      max_weight_(static_cast<float>(map.config().max_weight)),
      worth_(frame.pace.worth()),
      another_pass_(frame.pace.framesIn(kAnotherPass_s)),
      unnoticed_(frame.pace.framesIn(kUnnoticed_s)) {}

SurfelUpdate::Result SurfelUpdate::update(const SurfelRange& range, SurfelArrays& s) const {
  Result result;
  result.stable_too = static_cast<int>(range.block) % kTurns == map_.frame() % kTurns;
  ProjectedRange seen;
  project(s, range, projection_, seen);
  Places places;
  for (std::uint32_t next = 0; next < range.end - range.begin;) {
    const std::size_t count = findPlaces(s, range, seen, next, places);
    for (std::size_t k = 0; k < count; ++k) {
      if (!updateOne(s, places[k], result)) {
        doubt(s, places[k], result);
        continue;
      }
      const std::size_t i = places[k].surfel;
      ++result.merged;
      result.moved.extend(Eigen::Vector3f(s.x[i], s.y[i], s.z[i]));
    }
  }
  return result;
}

/// The next surfels of a range that are in view, from number `next` on. What is measured there is
/// on its way from memory when they are updated.
std::size_t SurfelUpdate::findPlaces(const SurfelArrays& s, const SurfelRange& range,
                                     const ProjectedRange& seen, std::uint32_t& next,
                                     Places& places) const {
  const MeasuredSurface& surface = evidence_.measured;
  const float right = projection_.width - 0.5F, bottom = projection_.height - 0.5F;
  std::size_t count = 0;
  for (; next < range.end - range.begin && count < kBatch; ++next) {
    const float u = seen.u[next], v = seen.v[next], z = seen.z[next];
    if (seen.inside[next] == 0 || !(u > -0.5F && v > -0.5F && u < right && v < bottom)) continue;
    const std::uint32_t i = range.begin + next;
    if (!map_.isActive(s, i) || map_.isDead(s, i)) continue;
    const MeasuredSurface::Level& level = surface[surface.levelOf(z)];
    // Half a pixel outside the working frame is outside of all levels: never below 0.
    const int lu = std::min(static_cast<int>((u + 0.5F) * level.scale), level.depth_m.cols - 1);
    const int lv = std::min(static_cast<int>((v + 0.5F) * level.scale), level.depth_m.rows - 1);
    __builtin_prefetch(level.depth_m.ptr<float>(lv) + lu);
    __builtin_prefetch(level.color.ptr<cv::Vec3b>(lv) + lu);
    __builtin_prefetch(evidence_.explained.at(level.at(lu, lv)), 1);
    places[count++] = {seen.x[next],
                       seen.y[next],
                       z,
                       u,
                       v,
                       static_cast<int>(u + 0.5F),
                       static_cast<int>(v + 0.5F),
                       seen.reach[next],
                       seen.facing[next],
                       i,
                       &level,
                       lu,
                       lv};
  }
  return count;
}

/// True when this frame supports the surfel.
bool SurfelUpdate::updateOne(SurfelArrays& s, const Place& p, Result& result) const {
  const std::size_t i = p.surfel;
  const float tolerance = agreement(p.z);
  if (!evidence_.person_m.empty()) {
    const float person = evidence_.person_m.at<float>(p.v, p.u);
    if (person > 0 && std::abs(person - p.z) <= tolerance) {
      if (contradictOne(s, i)) ++result.refuted;
      return false;
    }
  }
  if (evidence_.free_m.at<float>(p.v, p.u) > p.z + kSeenThrough * tolerance) {
    if (contradictOne(s, i, kSeenThroughFrames)) ++result.refuted;
    return false;
  }
  const Measurement m = measure(p);
  if (m.depth <= 0) {
    if (isOther(s, p) && contradictOne(s, i, kOtherFrames)) ++result.refuted;
    return false;
  }
  const float off = std::abs(m.depth - p.z);
  if (p.z - m.depth > kWellBefore_m && map_.isStable(s, i)) {
    evidence_.known_behind.mark(p.u, p.v, m.depth);
  }
  if (off > std::max(tolerance, kMostLayer_m)) return false;
  Eigen::Vector3f own;
  to_camera_.direction(s.nx[i], s.ny[i], s.nz[i], own.x(), own.y(), own.z());
  const float cosine = m.n.dot(own);
  if (off > tolerance) {
    if (isLayer(p, m.depth, cosine)) {
      result.layers.push_back(
          {p.surfel, static_cast<std::uint32_t>(p.level->at(p.level_u, p.level_v))});
    }
    return false;
  }
  // From behind, it is the other side of a thin board that is measured; unless the surfel is seen
  // edge-on, and noise turned it away.
  if (p.facing > 0 && cosine < min_cosine_) return false;
  const bool stable = map_.isStable(s, i);
  explain(p, stable ? s.created[i] : map_.frame());
  if (!stable || (result.stable_too && s.created[i] >= another_pass_)) {
    result.supported.push_back(supportedAt(s, p));
  }
  merge(s, p, m, cosine);
  return true;
}

/// Where nothing is measured, the surface may yet be there: shiny, dark, or in the shadow of the
/// projector; but then its colour is. Of another colour it is hidden by something too near, or it
/// has gone, and what is seen is out of range: a person has left the wall of a hall.
bool SurfelUpdate::isOther(const SurfelArrays& s, const Place& p) const {
  if (evidence_.gaps.at<std::uint8_t>(p.v, p.u) == 0) return false;
  const std::size_t i = p.surfel;
  const cv::Vec3b& color = p.level->color.ptr<cv::Vec3b>(p.level_v)[p.level_u];
  const float off = std::max({std::abs(exposed(color[0], options_) - s.r[i]),
                              std::abs(exposed(color[1], options_) - s.g[i]),
                              std::abs(exposed(color[2], options_) - s.b[i])});
  return off > kOtherColor;
}

/// Surfels made close to a person not long ago, and not seen now, may have been mapped from that
/// person before detection: they are removed also where nothing is seen behind them.
void SurfelUpdate::doubt(SurfelArrays& s, const Place& p, Result& result) const {
  const bool is_young = s.created[p.surfel] > map_.frame() - unnoticed_;
  if (is_young && evidence_.near_people.has(p.u, p.v, p.z) &&
      contradictOne(s, p.surfel, kUnnoticedFrames)) {
    ++result.refuted;
  }
}

bool SurfelUpdate::contradictOne(SurfelArrays& s, std::size_t i, float frames) const {
  if (!options_.may_remove_stable && map_.isStable(s, i)) return false;
  s.odds[i] = static_odds::contradicted(s.odds[i], worth_ * frames);
  return s.odds[i] <= static_odds::kGone;
}

/// Its depth is where the surfel's ray meets the plane measured at the pixel next to it; the
/// pixel's own depth where that has no normal. Without this a leaning surface would gain up to half
/// a pixel's slope with each merge.
SurfelUpdate::Measurement SurfelUpdate::measure(const Place& p) const {
  const MeasuredSurface::Level& level = *p.level;
  const float depth = level.depth_m.ptr<float>(p.level_v)[p.level_u];
  if (depth <= 0) return {0.0F, Eigen::Vector3f::Zero()};
  const Eigen::Vector3f n = evidence_.measured.normal(p.u, p.v, depth);
  const float cosine = n.dot(Eigen::Vector3f(p.x / p.z, p.y / p.z, 1.0F));
  if (cosine > -kMinCosine) return {depth, n};
  const Eigen::Vector3f pixel_ray(level.rayX(p.level_u), level.rayY(p.level_v), 1.0F);
  return {depth * n.dot(pixel_ray) / cosine, n};
}

/// On all levels on which a pixel that agrees with the surfel may be looked for.
void SurfelUpdate::explain(const Place& p, std::int32_t made) const {
  const MeasuredSurface& surface = evidence_.measured;
  const float tolerance = agreement(p.z);
  const std::int64_t by = Explanation::of(made, p.z);
  const int near = surface.levelOf(p.z - tolerance), far = surface.levelOf(p.z + tolerance);
  for (int i = std::min(near, far); i <= std::max(near, far); ++i) {
    const float scale = surface[i].scale;
    const float reach =
        std::max(0.5F, std::min(kExplainedShare * p.reach_px * scale, kMostExplained_px));
    evidence_.explained.offer(surface[i], (p.fu + 0.5F) * scale - 0.5F,
                              (p.fv + 0.5F) * scale - 0.5F, reach, by);
  }
}

/// Running weighted mean of depth along the pixel's ray, normal, colour and radius.
void SurfelUpdate::merge(SurfelArrays& s, const Place& p, const Measurement& m,
                         float cosine) const {
  const std::size_t i = p.surfel;
  s.seen[i] = map_.frame();
  s.odds[i] = static_odds::supported(s.odds[i], worth_);
  const float facing = -p.facing / std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  if (cosine < min_cosine_ || facing < kMinCosine) return;
  const float gain = measurementWeight(frame_.sensor, m.depth);
  const float old = std::min(s.weight[i], max_weight_);
  const float share = gain / (old + gain);
  s.weight[i] = old + gain;
  const float scale = 1.0F + share * (m.depth - p.z) / p.z;
  to_map_.point(p.x * scale, p.y * scale, p.z * scale, s.x[i], s.y[i], s.z[i]);
  mergeNormal(s, i, share, m.n);
  const cv::Vec3b& color = p.level->color.ptr<cv::Vec3b>(p.level_v)[p.level_u];
  s.r[i] += share * (exposed(color[0], options_) - s.r[i]);
  s.g[i] += share * (exposed(color[1], options_) - s.g[i]);
  s.b[i] += share * (exposed(color[2], options_) - s.b[i]);
  // A closer look makes it finer, never coarser.
  const float radius = footprintRadius(m.depth, p.level->fx, facing);
  if (radius < s.radius[i]) s.radius[i] += share * (radius - s.radius[i]);
}

void SurfelUpdate::mergeNormal(SurfelArrays& s, std::size_t i, float share,
                               const Eigen::Vector3f& n) const {
  float mx, my, mz;
  to_map_.direction(n.x(), n.y(), n.z(), mx, my, mz);
  const float x = s.nx[i] + share * (mx - s.nx[i]);
  const float y = s.ny[i] + share * (my - s.ny[i]);
  const float z = s.nz[i] + share * (mz - s.nz[i]);
  const float inverse = 1.0F / std::sqrt(x * x + y * y + z * z);
  s.nx[i] = x * inverse;
  s.ny[i] = y * inverse;
  s.nz[i] = z * inverse;
}

}  // namespace pf

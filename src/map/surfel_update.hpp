// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "explained.hpp"
#include "known_behind.hpp"
#include "measured_surface.hpp"
#include "near_people.hpp"
#include "posefusion/core/rigid_motion.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/map/fusion.hpp"
#include "posefusion/map/surfel_map.hpp"
#include "projection.hpp"

namespace pf {

/// What lies this far in front of a stable surface may have come there.
constexpr float kWellBefore_m = 0.25F;
/// Seen so many tolerances beyond a surface, a frame sees through it.
constexpr float kSeenThrough = 1.5F;

/// Evidence of a frame on the space along its pixels' rays. Planes have the working frame's size.
struct Evidence {
  MeasuredSurface measured;
  cv::Mat free_m;    ///< CV_32FC1: seen to be empty up to here in all of 3x3 pixels; 0: not known
  cv::Mat gaps;      ///< CV_8UC1: see findGaps()
  cv::Mat person_m;  ///< CV_32FC1: depth of people and what else moves, 0 = none; may be empty
  NearPeople near_people;  ///< around all people in view
  Explained explained;
  KnownBehind known_behind;
};

/// The update of the surfels of one range from one frame. Threads may share it: each call writes
/// the surfels of its range alone, and marks pixels as explained.
class SurfelUpdate {
 public:
  /// All arguments must outlive this.
  SurfelUpdate(const WorkingFrame& frame, const Eigen::Isometry3d& T_map_camera,
               const FusionOptions& options, const SurfelMap& map, Evidence& evidence);

  /// A surfel close to the measured surface, parallel to it, and yet no part of it.
  struct Layer {
    std::uint32_t surfel, pixel;  ///< of those of all levels
  };
  /// A surfel that the measurement supports, as the camera sees it.
  struct Supported {
    std::uint32_t surfel, pixel;
    float z;         ///< m
    float cosine;    ///< of its normal with the ray
    float beside_m;  ///< what agrees with the same pixel may lie so far beside it
  };
  struct Result {
    std::size_t merged = 0;     ///< surfels that this frame supports
    std::size_t refuted = 0;    ///< surfels that this frame removes
    Eigen::AlignedBox3f moved;  ///< the new places of those
    std::vector<Layer> layers;
    bool stable_too = false;           ///< whether `supported` has stable surfels
    std::vector<Supported> supported;  ///< of those that may be doubled
  };
  Result update(const SurfelRange& range, SurfelArrays& surfels) const;

  /// To be called after all ranges were updated. Of two layers of one surface, the younger is the
  /// wrong one: the frame contradicts it, also where its measurement is near enough to both.
  void contradict(const Result& result, SurfelArrays& surfels) const;

 private:
  /// A surfel in the camera frame.
  struct Place {
    float x, y, z;
    float fu, fv;    ///< pixel of the working frame
    int u, v;        ///< the same, rounded
    float reach_px;  ///< radius
    float facing;    ///< normal . (x, y, z): above 0 it is seen from behind
    std::uint32_t surfel;
    const MeasuredSurface::Level* level;  ///< that shows a surface at its distance
    int level_u, level_v;                 ///< pixel of it
  };
  static constexpr std::size_t kBatch = 64;
  /// Few stable surfels are doubled: those of a block are looked at once in so many frames.
  static constexpr int kTurns = 4;
  using Places = std::array<Place, kBatch>;
  /// What the frame measures there.
  struct Measurement {
    float depth;        ///< m, on the surfel's ray; 0: nothing
    Eigen::Vector3f n;  ///< normal; 0 where there is none
  };
  std::size_t findPlaces(const SurfelArrays& s, const SurfelRange& range,
                         const ProjectedRange& seen, std::uint32_t& next, Places& places) const;
  bool updateOne(SurfelArrays& s, const Place& p, Result& result) const;
  bool isOther(const SurfelArrays& s, const Place& p) const;
  float agreement(float z) const { return evidence_.measured.agreement(z); }
  bool isLayer(const Place& p, float measured, float cosine) const;
  void doubt(SurfelArrays& s, const Place& p, Result& result) const;
  /// By so many frames like this one. True when that refutes it.
  bool contradictOne(SurfelArrays& s, std::size_t i, float frames = 1) const;
  Measurement measure(const Place& p) const;
  void explain(const Place& p, std::int32_t made) const;
  Supported supportedAt(const SurfelArrays& s, const Place& p) const;
  bool isDoubled(const Supported& seen, std::int32_t before) const;
  void merge(SurfelArrays& s, const Place& p, const Measurement& m, float cosine) const;
  void mergeNormal(SurfelArrays& s, std::size_t i, float share, const Eigen::Vector3f& n) const;

  const WorkingFrame& frame_;
  const FusionOptions& options_;
  const SurfelMap& map_;
  Evidence& evidence_;
  Projection projection_;
  RigidMotion to_camera_, to_map_;
  float min_cosine_, max_weight_;
  float worth_;                            // of the frame, see Pace
  std::int32_t another_pass_, unnoticed_;  // frames
};

}  // namespace pf

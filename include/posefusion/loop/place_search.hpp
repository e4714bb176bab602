// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "posefusion/core/camera.hpp"
#include "posefusion/core/map_pose.hpp"
#include "posefusion/frame/working_frame.hpp"
#include "posefusion/loop/map_points.hpp"

namespace pf {

/// A level surface that a camera sees, and may be held above.
struct SeenFloor {
  Eigen::Vector3d up;  ///< direction against gravity in the camera frame
  double below_m = 0;  ///< how far it is below the camera
};

/// A small frame to look for in the map, about 40x30 pixels, people left out.
struct PlaceQuery {
  PinholeCamera camera;
  DepthSensor sensor;
  cv::Mat depth_m;                 ///< CV_32FC1, 0 = nothing known
  cv::Mat intensity;               ///< CV_32FC1, 0..255
  cv::Mat facing;                  ///< CV_32FC1, cosine between ray and normal, 0 = nothing known
  std::optional<SeenFloor> floor;  ///< or a table, of a camera that is held about upright
  /// Surfaces beside the camera, so near that it may lie on them, on its side.
  std::vector<SeenFloor> beside;
};

/// Shrinks the coarsest level of the frame. `up_guess`: direction against gravity in the camera
/// frame that a floor in view is looked for around.
PlaceQuery placeQuery(const WorkingFrame& frame,
                      const Eigen::Vector3d& up_guess = -Eigen::Vector3d::UnitY());

/// The grid of poses.
struct PlaceSearchConfig {
  double reach_m = 0.9;  ///< each way, horizontally
  double step_m = 0.15;
  int headings = 48;                                   ///< of a full turn
  std::vector<double> heights_m = {-0.12, 0.0, 0.12};  ///< above that of the last pose
  double max_range_m = 0;  ///< farther points are not looked at; 0: by the range of the sensor
  int most = 50;           ///< candidates

  /// Of a pose found, from that which is searched around: a camera that fell lies lower.
  double farthest_m() const {
    constexpr double kFall_m = 1.5;
    return std::hypot(std::sqrt(2.0) * reach_m, kFall_m);
  }
};

/// The search 3 m each way, for a map that has just been loaded.
PlaceSearchConfig wideSearch();

/// Of these poses some from which such a search reaches around all; the last ones first.
std::vector<MapPose> spreadOut(const std::vector<MapPose>& poses);

struct PlaceCandidate {
  MapPose pose;
  double score = 0;        ///< at most 1.5; what the candidates are sorted by
  double explained = 0;    ///< part of the query's pixels where the map shows something
  double agreeing = 0;     ///< part of those at about the query's distance
  double correlation = 0;  ///< of the grey levels of those that agree, -1 to 1
};

/// Where the query may have been taken: the points of the pose's fragment are drawn from a grid of
/// positions around a pose and compared with it for all headings. From each position one panorama
/// is drawn (azimuth and elevation); a heading is a shift of it, so that a pose costs no drawing of
/// its own.
///
/// The score counts, per pixel of the query: at the right distance (within the noise and the grid)
/// up to +1, off by more -1, unknown to the map 0; and half the correlation of the grey levels.
///
/// `up` is the direction against gravity in the map frame of the fragment. The tilt of the camera
/// is that of `around` and, where known, that of the query's own floor or of a surface that it may
/// lie on. Best first, none within 0.2 m and 10 degrees of a better one. The bits do not depend on
/// the number of threads.
std::vector<PlaceCandidate> searchPlaces(const PointPyramid& points, const PlaceQuery& query,
                                         const MapPose& around, const Eigen::Vector3d& up,
                                         const PlaceSearchConfig& config);

}  // namespace pf

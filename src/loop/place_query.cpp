// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "posefusion/frame/depth_filter.hpp"
#include "posefusion/loop/place_search.hpp"

namespace pf {
namespace {

constexpr double kUpReach_rad = 0.9;
// A head that lies on the floor is not higher above it.
constexpr double kLyingHeight_m = 0.6;
// So far from each other are poses to search around: a search reaches 0.9 m each way.
constexpr double kRoomSide_m = 1.0;

/// Points and normals of a level, camera frame.
struct LevelPoints {
  std::vector<float> planes[6];

  explicit LevelPoints(const FrameLevel& level) {
    for (int v = 0; v < level.depth_m.rows; ++v) {
      for (int u = 0; u < level.depth_m.cols; ++u) {
        if (level.normal_z.at<float>(v, u) >= 0) continue;
        const Eigen::Vector3d point = level.camera.unproject(u, v, level.depth_m.at<float>(v, u));
        for (int i = 0; i < 3; ++i) planes[i].push_back(static_cast<float>(point[i]));
        planes[3].push_back(level.normal_x.at<float>(v, u));
        planes[4].push_back(level.normal_y.at<float>(v, u));
        planes[5].push_back(level.normal_z.at<float>(v, u));
      }
    }
  }

  /// The surfaces that face about `up`.
  std::optional<SeenFloor> floor(const Eigen::Vector3d& up) const {
    const OrientedPoints points{planes[0].data(), planes[1].data(), planes[2].data(),
                                planes[3].data(), planes[4].data(), planes[5].data(),
                                planes[0].size()};
    const auto levels = findLevels(points, up, kUpReach_rad);
    if (!levels) return std::nullopt;
    return SeenFloor{levels->up, -levels->lowest_m};
  }
};

/// `up_guess`: of the camera held upright, camera frame.
void findFloors(const FrameLevel& level, const Eigen::Vector3d& up_guess, PlaceQuery& query) {
  const LevelPoints points(level);
  query.floor = points.floor(up_guess);
  const Eigen::Vector3d side = up_guess.cross(Eigen::Vector3d::UnitZ());
  if (side.isZero(1e-3)) return;
  for (const double sign : {1.0, -1.0}) {
    const auto floor = points.floor(sign * side.normalized());
    if (floor && floor->below_m > 0 && floor->below_m < kLyingHeight_m) {
      query.beside.push_back(*floor);
    }
  }
}

}  // namespace

PlaceSearchConfig wideSearch() {
  PlaceSearchConfig config;
  config.reach_m = 3.0;
  config.step_m = 0.3;
  config.headings = 36;
  return config;
}

std::vector<MapPose> spreadOut(const std::vector<MapPose>& poses) {
  std::vector<MapPose> chosen;
  for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {
    const Eigen::Vector3d at = pose->T_map_camera.translation();
    const auto near = [&](const MapPose& other) {
      return other.fragment == pose->fragment &&
             (other.T_map_camera.translation() - at).norm() < kRoomSide_m;
    };
    if (std::none_of(chosen.begin(), chosen.end(), near)) chosen.push_back(*pose);
  }
  return chosen;
}

PlaceQuery placeQuery(const WorkingFrame& frame, const Eigen::Vector3d& up_guess) {
  const FrameLevel& coarse = frame.levels[kLevels - 1];
  PlaceQuery query;
  query.camera = coarse.camera.shrunk(2);
  query.sensor = frame.sensor;
  shrinkDepth(coarse.depth_m, 2, frame.sensor, query.depth_m);
  halveIntensity(coarse.intensity, query.intensity);
  cv::Mat people;
  cv::resize(coarse.still, people, query.depth_m.size(), 0, 0, cv::INTER_AREA);
  query.depth_m.setTo(0, people < 255);
  query.facing = cv::Mat(query.depth_m.size(), CV_32FC1, cv::Scalar(0));
  for (int v = 0; v < query.facing.rows; ++v) {
    for (int u = 0; u < query.facing.cols; ++u) {
      const Eigen::Vector3d ray = query.camera.unproject(u, v, 1.0).normalized();
      const Eigen::Vector3d normal(coarse.normal_x.at<float>(2 * v, 2 * u),
                                   coarse.normal_y.at<float>(2 * v, 2 * u),
                                   coarse.normal_z.at<float>(2 * v, 2 * u));
      query.facing.at<float>(v, u) = static_cast<float>(-normal.dot(ray));
    }
  }
  findFloors(coarse, up_guess, query);
  return query;
}

}  // namespace pf

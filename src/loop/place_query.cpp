// SPDX-License-Identifier: BSD-3-Clause
#include <opencv2/imgproc.hpp>

#include "posefusion/frame/depth_filter.hpp"
#include "posefusion/loop/place_search.hpp"

namespace pf {
namespace {

constexpr double kUpReach_rad = 0.9;

/// Sets the query's `up` and `floor_m` from the surfaces that face up.
void findFloor(const FrameLevel& level, const Eigen::Vector3d& up_guess, PlaceQuery& query) {
  std::vector<float> p[6];
  for (int v = 0; v < level.depth_m.rows; ++v) {
    for (int u = 0; u < level.depth_m.cols; ++u) {
      if (level.normal_z.at<float>(v, u) >= 0) continue;
      const Eigen::Vector3d point = level.camera.unproject(u, v, level.depth_m.at<float>(v, u));
      for (int i = 0; i < 3; ++i) p[i].push_back(static_cast<float>(point[i]));
      p[3].push_back(level.normal_x.at<float>(v, u));
      p[4].push_back(level.normal_y.at<float>(v, u));
      p[5].push_back(level.normal_z.at<float>(v, u));
    }
  }
  const auto levels = findLevels(
      {p[0].data(), p[1].data(), p[2].data(), p[3].data(), p[4].data(), p[5].data(), p[0].size()},
      up_guess, kUpReach_rad);
  if (!levels) return;
  query.up = levels->up;
  query.floor_m = -levels->lowest_m;
}

}  // namespace

PlaceSearchConfig wideSearch() {
  PlaceSearchConfig config;
  config.reach_m = 3.0;
  config.step_m = 0.3;
  config.headings = 36;
  return config;
}

PlaceQuery placeQuery(const WorkingFrame& frame, const Eigen::Vector3d& up_guess) {
  const FrameLevel& coarse = frame.levels[kLevels - 1];
  PlaceQuery query;
  query.camera = coarse.camera.shrunk(2);
  shrinkDepth(coarse.depth_m, 2, query.depth_m);
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
  findFloor(coarse, up_guess, query);
  return query;
}

}  // namespace pf

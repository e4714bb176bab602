// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/keyframe_pair.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr float kFullSupport = 30.0F;  // a keyframe stands for itself
constexpr int kRounds = 2;
constexpr double kSettled_m = 0.01, kSettled_rad = 0.01;

}  // namespace

KeyframeView keyframeView(const WorkingFrame& frame, std::int64_t id,
                          const Eigen::Isometry3d& T_map_camera, bool nobody_in_view) {
  KeyframeView view;
  view.id = id;
  view.camera = frame.camera;
  view.T_map_camera = T_map_camera;
  view.nobody_in_view = nobody_in_view;
  view.thumbnail = thumbnailOf(frame);
  frame.levels[0].intensity.convertTo(view.intensity, CV_8U);
  frame.depth_m.convertTo(view.depth_mm, CV_16U, 1000.0);
  view.depth_mm.setTo(0, frame.levels[0].still == 0);
  return view;
}

WorkingFrame workingFrameOf(const KeyframeView& view) {
  RgbdFrame frame;
  cv::cvtColor(view.intensity, frame.color, cv::COLOR_GRAY2RGB);
  frame.depth = view.depth_mm;
  frame.camera = view.camera;
  FrameConfig whole;
  whole.shrink = 1;
  WorkingFrame working;
  working.assign(frame, cv::Mat(), whole);
  return working;
}

ModelView modelViewOf(const WorkingFrame& frame) {
  const FrameLevel& level = frame.levels[0];
  ModelView view;
  view.camera = level.camera;
  view.depth_m = level.depth_m.clone();
  view.depth_m.setTo(0, level.normal_z >= 0);
  view.normal_x = level.normal_x;
  view.normal_y = level.normal_y;
  view.normal_z = level.normal_z;
  view.intensity = level.intensity;
  view.support = cv::Mat(level.depth_m.size(), CV_32FC1, cv::Scalar(kFullSupport));
  return view;
}

ModelView seenFrom(const ModelView& view, const Eigen::Isometry3d& T_view_camera) {
  ModelView moved;
  moved.camera = view.camera;
  moved.T_map_camera = view.T_map_camera * T_view_camera;
  for (cv::Mat* plane : {&moved.depth_m, &moved.normal_x, &moved.normal_y, &moved.normal_z,
                         &moved.intensity, &moved.support}) {
    *plane = cv::Mat::zeros(view.depth_m.size(), CV_32FC1);
  }
  const Eigen::Isometry3d T = T_view_camera.inverse();
  for (int v = 0; v < view.depth_m.rows; ++v) {
    for (int u = 0; u < view.depth_m.cols; ++u) {
      const float depth = view.depth_m.at<float>(v, u);
      if (depth <= 0) continue;
      const Eigen::Vector3d p = T * view.camera.unproject(u, v, depth);
      if (p.z() <= 0) continue;
      const Eigen::Vector2d pixel = view.camera.project(p);
      const int x = static_cast<int>(std::lround(pixel.x()));
      const int y = static_cast<int>(std::lround(pixel.y()));
      if (x < 0 || y < 0 || x >= view.depth_m.cols || y >= view.depth_m.rows) continue;
      float& nearest = moved.depth_m.at<float>(y, x);
      if (nearest > 0 && nearest <= p.z()) continue;
      const Eigen::Vector3d n =
          T.linear() * Eigen::Vector3d(view.normal_x.at<float>(v, u), view.normal_y.at<float>(v, u),
                                       view.normal_z.at<float>(v, u));
      nearest = static_cast<float>(p.z());
      moved.normal_x.at<float>(y, x) = static_cast<float>(n.x());
      moved.normal_y.at<float>(y, x) = static_cast<float>(n.y());
      moved.normal_z.at<float>(y, x) = static_cast<float>(n.z());
      moved.intensity.at<float>(y, x) = view.intensity.at<float>(v, u);
      moved.support.at<float>(y, x) = view.support.at<float>(v, u);
    }
  }
  return moved;
}

PlaceVerdict alignPair(const WorkingFrame& from, const WorkingFrame& to,
                       const Eigen::Isometry3d& T_from_to_guess, const TrackingConfig& tracking,
                       const VerifyLimits& limits) {
  const ModelView model = modelViewOf(from);
  ModelPyramid points;
  points.assign(model);
  PlaceVerdict verdict;
  verdict.alignment.T_map_camera = T_from_to_guess;
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Isometry3d T = verdict.alignment.T_map_camera;
    TrackingStart start = freeStart(T);
    start.T_map_view.setIdentity();
    start.brightness = verdict.alignment.brightness;
    verdict.alignment = track(to, points, start, tracking);
    if (isWithin(T.inverse() * verdict.alignment.T_map_camera, kSettled_m, kSettled_rad)) break;
  }
  verdict.agreement = compareViews(to, seenFrom(model, verdict.alignment.T_map_camera));
  verdict.doubt = judgePlace(verdict, T_from_to_guess, limits);
  return verdict;
}

}  // namespace pf

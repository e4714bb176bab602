// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/keyframe_pair.hpp"

#include <opencv2/imgproc.hpp>

#include "posefusion/core/rigid_motion.hpp"
#include "posefusion/core/same_pose.hpp"
#include "posefusion/loop/own_view.hpp"

namespace pf {
KeyframeView keyframeView(const WorkingFrame& frame, std::int64_t id, const MapPose& pose,
                          bool nobody_in_view) {
  KeyframeView view;
  view.id = id;
  view.camera = frame.camera;
  view.pose = pose;
  view.nobody_in_view = nobody_in_view;
  view.thumbnail = thumbnailOf(frame);
  frame.levels[0].intensity.convertTo(view.intensity, CV_8U);
  frame.depth_m.convertTo(view.depth_mm, CV_16U, 1000.0);
  view.depth_mm.setTo(0, frame.levels[0].still == 0);
  return view;
}

void KeyframePicture::assign(const KeyframeView& view, const DepthSensor& sensor) {
  RgbdFrame whole;
  cv::cvtColor(view.intensity, whole.color, cv::COLOR_GRAY2RGB);
  whole.depth = view.depth_mm;
  whole.camera = view.camera;
  FrameConfig config;
  config.shrink = 1;
  config.min_depth_m = sensor.min_depth_m;
  config.max_depth_m = sensor.max_depth_m;
  frame.assign(whole, cv::Mat(), config, sensor);
  ownView(frame.levels[0], model);
  points.assign(model, sensor);
}

void seenFrom(const ModelView& view, const Eigen::Isometry3d& T_view_camera, ModelView& moved) {
  moved.camera = view.camera;
  moved.T_map_camera = view.T_map_camera * T_view_camera;
  for (cv::Mat* plane :
       {&moved.depth_m, &moved.normal_x, &moved.normal_y, &moved.normal_z, &moved.intensity}) {
    plane->create(view.depth_m.size(), CV_32FC1);
  }
  moved.depth_m.setTo(0);
  const RigidMotion motion(T_view_camera.inverse());
  const auto fx = static_cast<float>(view.camera.fx), fy = static_cast<float>(view.camera.fy);
  const auto cx = static_cast<float>(view.camera.cx), cy = static_cast<float>(view.camera.cy);
  const int rows = view.depth_m.rows, cols = view.depth_m.cols;
  for (int v = 0; v < rows; ++v) {
    const auto* depth = view.depth_m.ptr<float>(v);
    for (int u = 0; u < cols; ++u) {
      const float z = depth[u];
      if (z <= 0) continue;
      float px, py, pz;
      motion.point((static_cast<float>(u) - cx) / fx * z, (static_cast<float>(v) - cy) / fy * z, z,
                   px, py, pz);
      if (pz <= 0) continue;
      const float fu = fx * px / pz + cx, fv = fy * py / pz + cy;
      const bool inside = fu > -0.5F && fv > -0.5F && fu < static_cast<float>(cols) - 0.5F &&
                          fv < static_cast<float>(rows) - 0.5F;
      if (!inside) continue;
      const int x = static_cast<int>(fu + 0.5F), y = static_cast<int>(fv + 0.5F);
      float& nearest = moved.depth_m.at<float>(y, x);
      if (nearest > 0 && nearest <= pz) continue;
      nearest = pz;
      motion.direction(view.normal_x.at<float>(v, u), view.normal_y.at<float>(v, u),
                       view.normal_z.at<float>(v, u), moved.normal_x.at<float>(y, x),
                       moved.normal_y.at<float>(y, x), moved.normal_z.at<float>(y, x));
      moved.intensity.at<float>(y, x) = view.intensity.at<float>(v, u);
    }
  }
}

PlaceVerdict PairAligner::align(const KeyframePicture& from, const KeyframePicture& to,
                                const Eigen::Isometry3d& T_from_to_guess) {
  TrackingStart start = freeStart(T_from_to_guess);
  start.T_map_view.setIdentity();
  PlaceVerdict verdict;
  verdict.alignment = track(to.frame, from.points, start, tracking_);
  seenFrom(from.model, verdict.alignment.T_map_camera, seen_);
  verdict.agreement = compareViews(to.frame, seen_);
  judgePlace(verdict, tracking_);
  return verdict;
}

bool PairAligner::confirms(const KeyframePicture& from, const KeyframePicture& to,
                           const Eigen::Isometry3d& T_from_to) {
  const PlaceVerdict back = align(to, from, T_from_to.inverse());
  return back.accepted() && isWithin(T_from_to * back.alignment.T_map_camera, kSamePose);
}

}  // namespace pf

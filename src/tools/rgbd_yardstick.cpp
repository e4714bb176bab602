// SPDX-License-Identifier: BSD-3-Clause
// The yardstick of the bench: OpenCV's RgbdICPOdometry (opencv_contrib, module rgbd) with its
// default settings, frame to frame over a TUM folder. Machines differ in speed; a ratio to this one
// does less.
#include <algorithm>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd.hpp>
#include <string>
#include <vector>

#include "posefusion/core/stopwatch.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/frame_source.hpp"
#include "tool.hpp"

namespace pf {
namespace {

using OdometryFrame = cv::rgbd::OdometryFrame;

cv::Mat matrixOf(const PinholeCamera& camera) {
  return (cv::Mat_<float>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
}

/// Grey image and depth in metres, NaN where there is none, as the odometry wants them.
cv::Ptr<OdometryFrame> odometryFrame(const RgbdFrame& frame) {
  cv::Mat grey, depth_m;
  cv::cvtColor(frame.color, grey, cv::COLOR_RGB2GRAY);
  depthInMetres(frame, 0.1, 20.0, depth_m);
  depth_m.setTo(std::numeric_limits<float>::quiet_NaN(), depth_m == 0);
  return OdometryFrame::create(grey, depth_m);
}

Eigen::Isometry3d poseOf(const cv::Mat& Rt) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 4; ++col) T(row, col) = Rt.at<double>(row, col);
  }
  return T;
}

/// The times (ms) of all frames but the first, and the path.
struct Walk {
  std::vector<double> times_ms;
  Trajectory trajectory;
  std::size_t failed = 0;  ///< frames that the odometry gave no motion for
};

Walk walk(FrameSource& source) {
  Walk walk;
  cv::Ptr<cv::rgbd::RgbdICPOdometry> odometry;
  cv::Ptr<OdometryFrame> last;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  while (auto next = source.next()) {
    if (!next->defect.empty()) continue;
    const RgbdFrame& frame = next->frame;
    if (!odometry) odometry = cv::rgbd::RgbdICPOdometry::create(matrixOf(frame.camera));
    cv::Ptr<OdometryFrame> current = odometryFrame(frame);
    if (last) {
      Stopwatch watch;
      cv::Mat Rt;
      const bool found = odometry->compute(current, last, Rt);
      walk.times_ms.push_back(watch.lapMs());
      if (found) T = T * poseOf(Rt);
      if (!found) ++walk.failed;
    }
    walk.trajectory.push_back({frame.stamp_ns, T});
    last = current;
  }
  return walk;
}

int yardstick(const std::string& folder) {
  const auto source = openTumFolder(folder);
  const Walk found = walk(*source);
  const auto pairs = matchPoses(source->truth(), found.trajectory);
  nlohmann::ordered_json out;
  out["frames"] = found.trajectory.size();
  out["failed"] = found.failed;
  out["median_ms"] = statisticsOf(found.times_ms).median;
  if (pairs.size() >= 3) out["ate_rmse_m"] = absoluteError(pairs, align(pairs, false)).rmse;
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{"Time and path of OpenCV's RgbdICPOdometry.", "posefusion_rgbd_yardstick"};
  std::string folder;
  app.addOption("sequence", folder, "TUM folder")->required();
  return pf::runTool(app, argc, argv, [&] { return pf::yardstick(folder); });
}

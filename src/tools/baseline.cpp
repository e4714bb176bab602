// SPDX-License-Identifier: BSD-3-Clause
// What others make of the same frames: the odometries of OpenCV (opencv_contrib, module rgbd) with
// their default settings, frame to frame over a recording. The bench holds speeds against
// RgbdICPOdometry: machines differ in speed; a ratio to this one does less.
#include <algorithm>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/core/error.hpp"
#include "posefusion/core/stopwatch.hpp"
#include "posefusion/evaluation/metrics.hpp"
#include "posefusion/io/trajectory_file.hpp"
#include "posefusion_ros/bags/bag_source.hpp"
#include "tool.hpp"

namespace pf {
namespace {

using OdometryFrame = cv::rgbd::OdometryFrame;

struct BaselineOptions {
  std::string input, output;
  std::string method = "rgbd_icp";
  std::size_t max_frames = 0;
  posefusion_ros::InputOptions reading;
};

cv::Ptr<cv::rgbd::Odometry> makeOdometry(const std::string& method, const PinholeCamera& camera) {
  const cv::Mat matrix =
      (cv::Mat_<float>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  if (method == "rgbd") return cv::rgbd::RgbdOdometry::create(matrix);
  if (method == "icp") return cv::rgbd::ICPOdometry::create(matrix);
  return cv::rgbd::RgbdICPOdometry::create(matrix);
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

struct Walk {
  std::vector<double> times_ms;  ///< of each frame but the first: reading left out
  Trajectory trajectory;         ///< first camera's frame; stands still where no motion is found
  std::size_t failed = 0;        ///< frames that the odometry gave no motion for
};

Walk walk(FrameSource& source, const BaselineOptions& options) {
  Walk walk;
  cv::Ptr<cv::rgbd::Odometry> odometry;
  cv::Ptr<OdometryFrame> last;
  Rectifier rectifier;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const std::size_t limit = options.max_frames > 0 ? options.max_frames : SIZE_MAX;
  while (walk.trajectory.size() < limit) {
    const auto next = source.next();
    if (!next) break;
    if (!next->defect.empty()) continue;
    const RgbdFrame frame = rectifier.rectify(next->frame);
    if (!odometry) odometry = makeOdometry(options.method, frame.camera);
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

int runBaseline(const BaselineOptions& options) {
  const auto source = posefusion_ros::openInput(options.input, options.reading);
  const Walk found = walk(*source, options);
  if (found.trajectory.empty()) {
    throw InputError(options.input + ": has no frame that can be read");
  }
  if (!options.output.empty()) {
    saveTrajectory(options.output, inWorld(bodyFromOptical(), found.trajectory),
                   "poses of the camera by OpenCV's odometry " + options.method);
  }
  const double sum_ms = std::accumulate(found.times_ms.begin(), found.times_ms.end(), 0.0);
  const auto pairs = matchPoses(source->truth(), found.trajectory);
  nlohmann::ordered_json out;
  out["method"] = options.method;
  out["frames"] = found.trajectory.size();
  out["failed"] = found.failed;
  out["median_ms"] = statisticsOf(found.times_ms).median;
  if (sum_ms > 0) {
    out["frames_per_s"] = 1e3 * static_cast<double>(found.times_ms.size()) / sum_ms;
  }
  if (pairs.size() >= 3) out["ate_rmse_m"] = absoluteError(pairs, align(pairs, false)).rmse;
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{
      "Trajectory and speed of OpenCV's odometries, frame to frame over a recording.",
      "posefusion_baseline"};
  pf::BaselineOptions options;
  app.addOption("input", options.input, "TUM folder or bag")->required();
  app.addOption("--method", options.method, "OpenCV's RgbdICPOdometry, RgbdOdometry, ICPOdometry")
      ->check(pf::oneOf({"rgbd_icp", "rgbd", "icp"}));
  app.addOption("--output", options.output, "trajectory to write, TUM format");
  app.addOption("--max-frames", options.max_frames, "stop after so many frames; 0: all");
  app.addOption("--camera", options.reading.camera_file, "camera file, instead of the input's own");
  app.addOption("--color-topic", options.reading.topics.color, "bag: colour images");
  app.addOption("--depth-topic", options.reading.topics.depth, "bag: registered depth images");
  app.addOption("--camera-info-topic", options.reading.topics.camera_info, "bag: the camera");
  return pf::runTool(app, argc, argv, [&] { return pf::runBaseline(options); });
}

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "posefusion/segmentation/segmenter.hpp"

namespace pf {

inline const PinholeCamera kCamera{640, 480, 525, 525, 319.5, 239.5, {}};
inline constexpr std::int64_t kFrame_ns = 33'333'333;

/// Depth of a round body at `z_m` whose pixels are `shape`.
inline void putBody(cv::Mat& depth_m, const cv::Mat& shape, float z_m, int centre_u) {
  for (int v = 0; v < shape.rows; ++v) {
    for (int u = 0; u < shape.cols; ++u) {
      if (shape.at<std::uint8_t>(v, u) == 0) continue;
      const float aside = static_cast<float>(u - centre_u) * z_m / 110.0F;  // 1: the shoulder
      depth_m.at<float>(v, u) = z_m + 0.15F * aside * aside;
    }
  }
}

/// A figure before a wall: a torso with a head, 1 m nearer than the wall.
struct Scene {
  RgbdFrame frame;
  cv::Mat truth = cv::Mat::zeros(480, 640, CV_8UC1);
  ModelView room;  ///< the wall alone
  People people;

  explicit Scene(float figure_z = 2.0F, int centre_u = 320, float wall_z = 3.0F) {
    cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(wall_z));
    room.camera = kCamera;
    room.depth_m = depth.clone();
    cv::Mat color(480, 640, CV_8UC3, cv::Scalar(200, 190, 170));
    const float k = 2.0F / figure_z;
    const auto at = [&](float du, float v) {
      return cv::Point2f(static_cast<float>(centre_u) + k * du, 240 + k * v);
    };
    cv::rectangle(truth, at(-55, -60), at(55, 170), cv::Scalar(255), cv::FILLED);
    cv::circle(truth, at(0, -95), cvRound(32 * k), cv::Scalar(255), cv::FILLED);
    putBody(depth, truth, figure_z, centre_u);
    color.setTo(cv::Scalar(30, 60, 120), truth);
    frame = {1, color, depth, 1e-3, kCamera};
    Person person;
    person.score = 1.0F;
    const auto put = [&](Joint joint, float du, float v) {
      const cv::Point2f p = at(du, v);
      person.joints[static_cast<int>(joint)] = {p.x, p.y, 0.8F};
    };
    put(Joint::nose, 0, -95);
    put(Joint::neck, 0, -50);
    put(Joint::right_shoulder, -40, -45);
    put(Joint::left_shoulder, 40, -45);
    put(Joint::right_hip, -30, 100);
    put(Joint::left_hip, 30, 100);
    people = {1, true, {person}};
  }
};

/// The figure's pixels as a detector would show them.
inline PersonMask maskOf(const Scene& scene) {
  PersonMask mask;
  cv::resize(scene.truth, mask.probability, {80, 60}, 0, 0, cv::INTER_AREA);
  cv::threshold(mask.probability, mask.owner, 127, 1, cv::THRESH_BINARY);
  return mask;
}

inline double iou(const cv::Mat& a, const cv::Mat& b) {
  return static_cast<double>(cv::countNonZero(a & b)) / std::max(1, cv::countNonZero(a | b));
}

/// A segmenter with the optical flow that its owner keeps.
class SegmenterChain {
 public:
  explicit SegmenterChain(const SegmentationConfig& config = {}) : segmenter_(config) {}

  Segmentation segment(const RgbdFrame& frame, const People& people, const ModelView* background) {
    flow_.advance(frame);
    return segmenter_.segment(frame, flow_.images(), people, background);
  }
  void reset() { segmenter_.reset(); }

 private:
  FlowTracker flow_;
  PeopleSegmenter segmenter_;
};

}  // namespace pf

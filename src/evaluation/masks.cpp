// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/evaluation/masks.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

constexpr double kCrowded = 0.02;  // part of the pixels
constexpr float kMaxStep_m = 0.1F;
constexpr int kMinPartPixels = 500;
constexpr int kMinJoints = 3;

/// Labels the parts of the true mask, from 1 on; 0 is no part or without depth.
cv::Mat labelParts(const cv::Mat& truth, const cv::Mat& depth_m, int& parts) {
  cv::Mat label = cv::Mat::zeros(truth.size(), CV_32SC1);
  const cv::Rect image(0, 0, truth.cols, truth.rows);
  std::vector<cv::Point> open;
  parts = 0;
  const auto take = [&](const cv::Point& p) {
    label.at<int>(p) = parts;
    open.push_back(p);
  };
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      if (truth.at<uchar>(y, x) == 0 || label.at<int>(y, x) != 0) continue;
      if (depth_m.at<float>(y, x) <= 0.0F) continue;
      ++parts;
      take({x, y});
      while (!open.empty()) {
        const cv::Point p = open.back();
        open.pop_back();
        for (const cv::Point& step : {cv::Point(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
          const cv::Point q = p + step;
          if (!image.contains(q) || truth.at<uchar>(q) == 0 || label.at<int>(q) != 0) continue;
          const float z = depth_m.at<float>(q);
          if (z > 0.0F && std::abs(z - depth_m.at<float>(p)) < kMaxStep_m) take(q);
        }
      }
    }
  }
  return label;
}

}  // namespace

cv::Mat foundParts(const cv::Mat& truth, const cv::Mat& depth_m, const People& people) {
  int parts = 0;
  const cv::Mat label = labelParts(truth, depth_m, parts);
  std::vector<int> pixels(parts + 1, 0), joints(parts + 1, 0);
  for (int y = 0; y < label.rows; ++y) {
    for (int x = 0; x < label.cols; ++x) ++pixels[label.at<int>(y, x)];
  }
  for (const Person& person : people.people) {
    for (const Keypoint& joint : person.joints) {
      const cv::Point at(cvRound(joint.u), cvRound(joint.v));
      const bool inside = cv::Rect(0, 0, label.cols, label.rows).contains(at);
      if (joint.p > 0.0F && inside) ++joints[label.at<int>(at)];
    }
  }
  cv::Mat found = cv::Mat::zeros(truth.size(), CV_8UC1);
  for (int y = 0; y < label.rows; ++y) {
    for (int x = 0; x < label.cols; ++x) {
      const int part = label.at<int>(y, x);
      if (part > 0 && joints[part] >= kMinJoints && pixels[part] >= kMinPartPixels) {
        found.at<uchar>(y, x) = 255;
      }
    }
  }
  cv::Mat closed;
  cv::morphologyEx(found, closed, cv::MORPH_CLOSE, cv::Mat::ones(5, 5, CV_8UC1));
  return closed & (truth > 0);
}

void MaskCheck::add(const cv::Mat& truth, const cv::Mat& mask, Sums& sums) {
  const double both = cv::countNonZero((truth > 0) & (mask > 0));
  const double either = cv::countNonZero((truth > 0) | (mask > 0));
  const double masked = cv::countNonZero(mask);
  ++sums.frames;
  sums.iou += both / either;
  sums.recall += both / cv::countNonZero(truth);
  if (masked == 0) return;
  ++sums.masked;
  sums.precision += both / masked;
}

void MaskCheck::add(const cv::Mat& truth, const cv::Mat& mask) {
  if (truth.size() != mask.size()) throw InputError("masks: of another size than the truth");
  const double pixels = static_cast<double>(truth.total());
  ++frames_;
  false_sum_ += cv::countNonZero((mask > 0) & (truth == 0)) / pixels;
  if (cv::countNonZero(truth) > kCrowded * pixels) add(truth, mask, crowded_);
}

void MaskCheck::addFound(const cv::Mat& truth, const cv::Mat& mask, const cv::Mat& found) {
  if (cv::countNonZero(found) == 0) return;
  const cv::Mat counted = (mask > 0) & ((truth == 0) | (found > 0));
  add(found, counted, found_);
}

MaskScore MaskCheck::mean(const Sums& sums) {
  if (sums.frames == 0) return {};
  return {sums.frames, sums.iou / sums.frames, sums.recall / sums.frames,
          sums.masked > 0 ? sums.precision / sums.masked : 0.0};
}

}  // namespace pf

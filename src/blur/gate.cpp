// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/blur/gate.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace pf {

double scoreBlur(const cv::Mat& color) {
  cv::Mat grey, response;
  cv::cvtColor(color, grey, cv::COLOR_RGB2GRAY);
  cv::Laplacian(grey, response, CV_16S, 1);
  cv::Scalar mean, deviation;
  cv::meanStdDev(response, mean, deviation);
  return deviation[0] * deviation[0];
}

BlurGate::BlurGate(const BlurConfig& config) : config_(config) {}

double BlurGate::threshold() const {
  if (config_.threshold > 0.0) return config_.threshold;
  if (accepted_.empty()) return 0.0;
  std::vector<double> scores(accepted_.begin(), accepted_.end());
  const auto middle = scores.begin() + static_cast<std::ptrdiff_t>(scores.size() / 2);
  std::nth_element(scores.begin(), middle, scores.end());
  return config_.relative_threshold * *middle;
}

BlurScore BlurGate::judge(double score) {
  BlurScore result;
  result.score = score;
  if (!config_.enabled) return result;
  result.threshold = threshold();
  const bool forced = drops_in_a_row_ >= config_.max_consecutive_drops;
  result.sharp = forced || score >= result.threshold;
  if (!result.sharp) {
    ++drops_in_a_row_;
    return result;
  }
  // A frame that passes by force joins the history too: the scene itself may have become dull
  // (a bare wall, a dark room), and the threshold has to follow it down.
  drops_in_a_row_ = 0;
  accepted_.push_back(score);
  if (static_cast<int>(accepted_.size()) > config_.history_frames) accepted_.pop_front();
  return result;
}

void BlurGate::reset() {
  accepted_.clear();
  drops_in_a_row_ = 0;
}

}  // namespace pf

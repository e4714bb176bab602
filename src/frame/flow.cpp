// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/frame/flow.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "posefusion/frame/picture_noise.hpp"

namespace pf {
namespace {

constexpr int kPyramidLevels = 3;
constexpr int kMaxCorners = 240;
constexpr double kCornerQuality = 0.004;  // part of the best corner's strength
// A window or a poster would take them all: cells of the image without a corner get some of their
// own.
constexpr int kCellColumns = 6, kCellRows = 5;
constexpr int kCornersPerCell = 4;
constexpr double kCellQuality = 0.1;  // part of the cell's best corner's strength
constexpr double kCornerSpacing_px = 7.0;
// Of noise alone the strength of a corner (cv::cornerMinEigenVal over 3x3 pixels) is this times its
// variance, and at the best places four times as much: noise is followed from frame to frame as
// if nothing moved.
constexpr int kCornerBlock = 3;
constexpr double kNoiseStrength = 108.0 / (3060.0 * 3060.0), kMostOfNoise = 5.0;
constexpr float kMaxReturnError_px = 0.7F;  // forth and back
const cv::Size kWindow(13, 13);
constexpr int kFlattened_px = 31;        // brightness counts against its mean over such a square
constexpr std::size_t kFewFollowed = 3;  // one in so many: the search begins anew elsewhere
constexpr double kCoarse = 0.25;         // of the pyramid's width, to see how the whole image moved

/// The centre of pixel 0 of an image shrunk by `scale` lies at (1 / scale - 1) / 2 of the large
/// one.
cv::Point2f toPyramid(const cv::Point2f& p, float scale) {
  return {(p.x + 0.5F) * scale - 0.5F, (p.y + 0.5F) * scale - 0.5F};
}

cv::Point2f toImage(const cv::Point2f& p, float scale) {
  return {(p.x + 0.5F) / scale - 0.5F, (p.y + 0.5F) / scale - 0.5F};
}

cv::TermCriteria stop() { return {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 12, 0.02}; }

/// Follows points (pyramid pixels) between two pyramids, from first guesses in `after`.
void follow(const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to,
            const std::vector<cv::Point2f>& before, std::vector<cv::Point2f>& after,
            std::vector<std::uint8_t>& found) {
  cv::calcOpticalFlowPyrLK(from, to, before, after, found, cv::noArray(), kWindow, kPyramidLevels,
                           stop(), cv::OPTFLOW_USE_INITIAL_FLOW);
}

}  // namespace

bool isSet(const cv::Mat& mask, const cv::Point2f& pixel) {
  const cv::Point at(cvRound(pixel.x), cvRound(pixel.y));
  return cv::Rect({}, mask.size()).contains(at) && mask.at<std::uint8_t>(at) != 0;
}

FollowedPoints FlowImages::follow(const std::vector<cv::Point2f>& before) const {
  FollowedPoints points{before, std::vector<std::uint8_t>(before.size(), 0)};
  if (!comparable_ || before.empty()) return points;
  std::vector<cv::Point2f> scaled(before);
  for (cv::Point2f& p : scaled) p = toPyramid(p, scale_);
  points.after = scaled;
  pf::follow(last_, newest_, scaled, points.after, points.found);
  for (cv::Point2f& p : points.after) p = toImage(p, scale_);
  return points;
}

const SparseFlow& FlowTracker::advance(const RgbdFrame& frame) {
  shrink(frame.color);
  cv::cvtColor(small_, grey_, cv::COLOR_RGB2GRAY);
  return advance(frame.color.size(), frame.stamp_ns);
}

const SparseFlow& FlowTracker::advance(const cv::Mat& grey, std::int64_t stamp_ns) {
  shrink(grey);
  small_.copyTo(grey_);
  return advance(grey.size(), stamp_ns);
}

/// Leaves the picture in small_.
void FlowTracker::shrink(const cv::Mat& picture) {
  const int width = std::min(kFlowWidth, picture.cols);
  images_.scale_ = static_cast<float>(width) / static_cast<float>(picture.cols);
  const int height = std::max(1, static_cast<int>(std::lround(picture.rows * images_.scale_)));
  cv::resize(picture, small_, {width, height}, 0, 0, cv::INTER_AREA);
}

/// Of the picture that lies in grey_.
const SparseFlow& FlowTracker::advance(cv::Size frame_size, std::int64_t stamp_ns) {
  images_.last_.swap(images_.newest_);
  flatten();
  images_.newest_.clear();
  cv::buildOpticalFlowPyramid(grey_, images_.newest_, kWindow, kPyramidLevels);
  images_.comparable_ = !images_.last_.empty() && frame_size_ == frame_size;
  frame_size_ = frame_size;
  SparseFlow& flow = images_.corners_;
  flow.before.clear();
  flow.after.clear();
  flow.ids.clear();
  flow.from_ns = newest_ns_;
  flow.to_ns = newest_ns_ = stamp_ns;
  if (images_.comparable_ && !corners_.empty()) followCorners();
  keep(flow.after);
  findCorners();
  return flow;
}

/// Takes slow changes of brightness out: a camera that changes its exposure is no motion.
void FlowTracker::flatten() {
  cv::boxFilter(grey_, mean_, CV_16S, {kFlattened_px, kFlattened_px});
  cv::subtract(grey_, mean_, mean_, cv::noArray(), CV_16S);
  mean_.convertTo(grey_, CV_8U, 1.0, 128.0);
}

/// Follows the corners into the newest frame; one counts only if it comes back the other way.
void FlowTracker::followCorners() {
  const auto attempt = [&](const cv::Point2f& shift) {
    there_ = corners_;
    for (cv::Point2f& p : there_) p += shift;
    pf::follow(images_.last_, images_.newest_, corners_, there_, found_);
    back_ = corners_;
    pf::follow(images_.newest_, images_.last_, there_, back_, returned_);
    std::size_t count = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const cv::Point2f error = back_[i] - corners_[i];
      found_[i] = found_[i] && returned_[i] && std::hypot(error.x, error.y) <= kMaxReturnError_px;
      count += found_[i];
    }
    return count;
  };
  // A fast turn, or frames that were dropped: further than flow reaches by itself.
  if (attempt({}) < corners_.size() / kFewFollowed) attempt(wholeShift());
  SparseFlow& flow = images_.corners_;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    if (found_[i] == 0) continue;
    flow.before.push_back(toImage(corners_[i], images_.scale_));
    flow.after.push_back(toImage(there_[i], images_.scale_));
    flow.ids.push_back(ids_[i]);
  }
}

/// By how much the image as a whole moved (pyramid pixels), from phase correlation (Kuglin and
/// Hines 1975) of its coarse level.
cv::Point2f FlowTracker::wholeShift() {
  const auto coarse = [&](const std::vector<cv::Mat>& pyramid, cv::Mat& out) {
    cv::resize(pyramid[0], small_, {}, kCoarse, kCoarse, cv::INTER_AREA);
    small_.convertTo(out, CV_32F);
  };
  coarse(images_.last_, coarse_before_);
  coarse(images_.newest_, coarse_after_);
  cv::createHanningWindow(hanning_, coarse_before_.size(), CV_32F);
  const cv::Point2d shift = cv::phaseCorrelate(coarse_before_, coarse_after_, hanning_);
  return {static_cast<float>(shift.x / kCoarse), static_cast<float>(shift.y / kCoarse)};
}

/// Goes on with the corners just followed, one in a place; new ones are found around them.
void FlowTracker::keep(const std::vector<cv::Point2f>& followed) {
  corners_.clear();
  ids_.clear();
  free_.create(grey_.size(), CV_8UC1);
  free_.setTo(255);
  for (std::size_t i = 0; i < followed.size(); ++i) {
    const cv::Point2f p = toPyramid(followed[i], images_.scale_);
    if (!isSet(free_, p)) continue;
    const cv::Point at(cvRound(p.x), cvRound(p.y));
    cv::circle(free_, at, static_cast<int>(kCornerSpacing_px), 0, cv::FILLED);
    corners_.push_back(p);
    ids_.push_back(images_.corners_.ids[i]);
  }
}

void FlowTracker::findCorners() {
  std::vector<cv::Point2f> found;
  const double noise = pictureNoise(grey_);
  cv::cornerMinEigenVal(grey_, strength_, kCornerBlock);
  strong_ = strength_ >= kMostOfNoise * kNoiseStrength * noise * noise;
  cv::bitwise_and(free_, strong_, free_);
  const int wanted = kMaxCorners - static_cast<int>(corners_.size());
  if (wanted > 0) {
    cv::goodFeaturesToTrack(grey_, found, wanted, kCornerQuality, kCornerSpacing_px, free_);
  }
  corners_.insert(corners_.end(), found.begin(), found.end());
  const cv::Size cell((grey_.cols + kCellColumns - 1) / kCellColumns,
                      (grey_.rows + kCellRows - 1) / kCellRows);
  std::vector<std::uint8_t> taken(kCellColumns * kCellRows, 0);
  for (const cv::Point2f& p : corners_) {
    const int row = static_cast<int>(p.y) / cell.height, col = static_cast<int>(p.x) / cell.width;
    taken[row * kCellColumns + col] = 1;
  }
  for (int i = 0; i < kCellColumns * kCellRows; ++i) {
    const cv::Point from(i % kCellColumns * cell.width, i / kCellColumns * cell.height);
    const cv::Rect area = cv::Rect(from, cell) & cv::Rect(0, 0, grey_.cols, grey_.rows);
    if (taken[i] != 0 || area.empty()) continue;
    cv::goodFeaturesToTrack(grey_(area), found, kCornersPerCell, kCellQuality, kCornerSpacing_px,
                            strong_(area));
    for (const cv::Point2f& p : found) corners_.emplace_back(p.x + from.x, p.y + from.y);
  }
  while (ids_.size() < corners_.size()) ids_.push_back(next_id_++);
}

void FlowTracker::reset() { *this = FlowTracker(); }

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/run/people_picture.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "posefusion/core/stamps.hpp"

namespace pf {
namespace {

constexpr std::size_t kColumns = 4;
constexpr std::size_t kPlaces = 2 * kColumns;
constexpr int kPictureWidth = 320;

const std::array<cv::Scalar, 6> kColors = {cv::Scalar(255, 170, 0),   cv::Scalar(0, 200, 255),
                                           cv::Scalar(120, 255, 0),   cv::Scalar(255, 80, 160),
                                           cv::Scalar(170, 120, 255), cv::Scalar(255, 255, 0)};

void drawSkeleton(const Person& person, const cv::Scalar& paint, cv::Mat& image) {
  for (const auto& [from, to] : kSkeletonLines) {
    const Keypoint& a = person.joints[static_cast<std::size_t>(from)];
    const Keypoint& b = person.joints[static_cast<std::size_t>(to)];
    if (a.p <= 0 || b.p <= 0) continue;
    cv::line(image, cv::Point2f(a.u, a.v), cv::Point2f(b.u, b.v), paint, 3, cv::LINE_AA);
  }
  for (const Keypoint& joint : person.joints) {
    if (joint.p > 0) cv::circle(image, cv::Point2f(joint.u, joint.v), 5, paint, -1, cv::LINE_AA);
  }
}

cv::Mat drawFrame(const ProcessedFrame& frame) {
  const Segmentation& s = frame.segmentation;
  const cv::Mat full = drawPeople(frame.seen.frame.color, s.people, s.mask);
  cv::Mat small;
  const int height = full.rows * kPictureWidth / full.cols;
  cv::resize(full, small, {kPictureWidth, height}, 0, 0, cv::INTER_AREA);
  cv::putText(small, formatStamp(frame.status.stamp_ns), {6, height - 8}, cv::FONT_HERSHEY_SIMPLEX,
              0.4, cv::Scalar(255, 255, 255), 1, cv::LINE_AA);
  return small;
}

}  // namespace

cv::Mat drawPeople(const cv::Mat& color, const People& people, const cv::Mat& mask) {
  cv::Mat image = color.clone();
  if (!mask.empty()) {
    cv::Mat tinted;
    cv::addWeighted(color, 0.5, cv::Mat(color.size(), CV_8UC3, cv::Scalar(230, 20, 60)), 0.5, 0,
                    tinted);
    tinted.copyTo(image, mask);
  }
  for (std::size_t i = 0; i < people.people.size(); ++i) {
    drawSkeleton(people.people[i], kColors[i % kColors.size()], image);
  }
  return image;
}

void PeopleStrip::Sample::add(const ProcessedFrame& frame) {
  if (seen++ % every != 0) return;
  if (pictures.size() == kPlaces) {
    for (std::size_t i = 0; i < kPlaces / 2; ++i) pictures[i] = pictures[2 * i];
    pictures.resize(kPlaces / 2);
    every *= 2;
    if ((seen - 1) % every != 0) return;
  }
  pictures.push_back(drawFrame(frame));
}

void PeopleStrip::add(const ProcessedFrame& frame) {
  const FrameOutcome outcome = frame.status.outcome;
  if (outcome == FrameOutcome::bad_input || outcome == FrameOutcome::blurred) return;
  const Segmentation& s = frame.segmentation;
  const bool has_mask = !s.mask.empty() && cv::countNonZero(s.mask) > 0;
  if (has_mask || !s.people.people.empty()) with_people_.add(frame);
  if (with_people_.pictures.empty()) any_.add(frame);
}

cv::Mat PeopleStrip::draw() const {
  const auto& pictures = with_people_.pictures.empty() ? any_.pictures : with_people_.pictures;
  if (pictures.empty()) return {};
  const cv::Size size = pictures.front().size();
  // Whole rows only: of five, say, four are shown.
  const std::size_t count =
      pictures.size() < kPlaces ? std::min(kColumns, pictures.size()) : kPlaces;
  const std::size_t columns = std::min(kColumns, count);
  const int rows = static_cast<int>(count / columns);
  cv::Mat strip(rows * size.height, static_cast<int>(columns) * size.width, CV_8UC3);
  for (std::size_t i = 0; i < count; ++i) {
    const cv::Point corner(static_cast<int>(i % columns) * size.width,
                           static_cast<int>(i / columns) * size.height);
    cv::resize(pictures[i * pictures.size() / count], strip(cv::Rect(corner, size)), size);
  }
  return strip;
}

}  // namespace pf

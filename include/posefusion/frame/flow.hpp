// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "posefusion/core/frame.hpp"

namespace pf {

/// Flow is measured on images of this width (pixels), or of the frame's where that is less.
constexpr int kFlowWidth = 320;

/// What corners are known to goes by half a pixel of those images, but not below a pixel of the
/// frame: how many pixels of a frame so wide that is. Measured, corners are off by 0.23 of it at
/// widths of 320, 640 and 1280.
inline double cornerPixel(int width) {
  return width > 2 * kFlowWidth ? static_cast<double>(width) / (2 * kFlowWidth) : 1.0;
}

/// Corners of one frame found again in the next, in pixels of the full image.
struct SparseFlow {
  std::int64_t from_ns = 0;  ///< stamp of the earlier frame
  std::int64_t to_ns = 0;    ///< stamp of the later frame
  std::vector<cv::Point2f> before, after;
  std::vector<std::uint32_t> ids;  ///< rising; a corner keeps its number while it is followed

  bool empty() const { return before.empty(); }

  /// The corners of which keep(before, after) is true.
  template <typename Keep>
  SparseFlow only(const Keep& keep) const {
    SparseFlow kept{from_ns, to_ns, {}, {}, {}};
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (!keep(before[i], after[i])) continue;
      kept.before.push_back(before[i]);
      kept.after.push_back(after[i]);
      kept.ids.push_back(ids[i]);
    }
    return kept;
  }
};

/// Whether a mask (CV_8UC1) is set at a pixel; false outside of it.
bool isSet(const cv::Mat& mask, const cv::Point2f& pixel);

/// Points followed from the last frame into the newest one.
struct FollowedPoints {
  std::vector<cv::Point2f> after;   ///< in the order of the question
  std::vector<std::uint8_t> found;  ///< 1 where the point was found again
};

/// Two successive frames, prepared for points to be followed from the first into the second. A
/// value: copies share the images, which do not change any more. Any number of threads.
class FlowImages {
 public:
  /// Follows points (pixels of the full image). None is found in the first frame of all or after a
  /// change of size.
  FollowedPoints follow(const std::vector<cv::Point2f>& before) const;

  /// The corners of the first frame that were followed into the second.
  const SparseFlow& corners() const { return corners_; }

 private:
  friend class FlowTracker;
  SparseFlow corners_;
  std::vector<cv::Mat> last_, newest_;  // pyramids
  float scale_ = 1.0F;                  // pyramid pixels per frame pixel
  bool comparable_ = false;
};

/// Sparse optical flow between successive frames (pyramidal Lucas and Kanade; Bouguet 2001) on
/// small grey images: of corners (Shi and Tomasi 1994), which give the motion of the camera, and of
/// any other points, which give that of people. The images are prepared once for both; slow changes
/// of brightness are taken out of them. Not thread safe.
class FlowTracker {
 public:
  /// Takes in the next frame and follows the corners of the one before; a corner counts only if it
  /// comes back when followed the other way. Empty for the first frame and after a change of size.
  const SparseFlow& advance(const RgbdFrame& frame);
  /// The same with a grey picture, CV_8UC1.
  const SparseFlow& advance(const cv::Mat& grey, std::int64_t stamp_ns);

  /// The frame before and the newest one.
  const FlowImages& images() const { return images_; }

  void reset();

 private:
  const SparseFlow& advance(cv::Size frame_size, std::int64_t stamp_ns);
  void shrink(const cv::Mat& picture);
  void flatten();
  void followCorners();
  cv::Point2f wholeShift();
  void keep(const std::vector<cv::Point2f>& corners);
  void findCorners();

  FlowImages images_;
  std::vector<cv::Point2f> corners_;  // of the newest frame, pixels of its pyramid
  std::vector<std::uint32_t> ids_;    // of the corners
  std::uint32_t next_id_ = 0;
  cv::Size frame_size_;
  std::int64_t newest_ns_ = 0;
  cv::Mat small_, grey_, mean_, free_, strength_, strong_, coarse_before_, coarse_after_, hanning_;
  std::vector<cv::Point2f> there_, back_;
  std::vector<std::uint8_t> found_, returned_;
};

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "posefusion/frame/working_frame.hpp"

namespace pf {

/// A small picture of a frame for ferns; people left out.
struct Thumbnail {
  static constexpr int kWidth = 80, kHeight = 60;

  cv::Mat color;    ///< CV_8UC3 R G B
  cv::Mat depth_m;  ///< CV_32FC1, 0 = nothing known
};

Thumbnail thumbnailOf(const WorkingFrame& frame);

struct FernConfig {
  int count = 500;
  std::uint32_t seed = 1;
  double max_depth_m = 5.0;
  double novelty = 0.3095;  ///< dissimilarity to all others from which a frame is stored
};

/// The code of each fern in a picture: four bits (red, green, blue, depth above their thresholds),
/// or kNoFern where nothing is known.
struct FernCode {
  static constexpr std::uint8_t kNoFern = 255;

  std::vector<std::uint8_t> bits;
  int good = 0;  ///< ferns with a code
};

struct FernMatch {
  std::int64_t id = 0;
  double dissimilarity = 1;  ///< 0 to 1
};

/// Keyframes by randomised ferns: Glocker et al., "Real-time RGB-D camera relocalization via
/// randomized ferns for keyframe encoding", TVCG 2015. Each fern looks at one pixel; pictures are
/// compared by the ferns with equal codes (block-wise Hamming distance). Lists of the keyframes of
/// each fern and code make a search cost what agrees, not what is stored. The same seed gives the
/// same ferns everywhere. Not thread safe.
class FernDatabase {
 public:
  /// Throws InputError naming the setting that cannot be.
  explicit FernDatabase(const FernConfig& config);

  FernCode encode(const Thumbnail& thumbnail) const;

  /// 1 - (ferns with equal codes) / (the smaller number of ferns with a code); 1 where one of the
  /// two has none.
  static double dissimilarity(const FernCode& a, const FernCode& b);

  /// The stored keyframes that are most alike, best first (equal ones: the older first), at most
  /// `most`.
  std::vector<FernMatch> nearest(const FernCode& code, std::size_t most) const;

  /// Stores a keyframe when it is unlike all others (at least a tenth of its ferns must have a
  /// code). Returns whether it did.
  bool harvest(std::int64_t id, const FernCode& code);

  /// Drops stored keyframes.
  void forget(const std::function<bool(std::int64_t id)>& is_forgotten);

  std::size_t size() const { return ids_.size(); }

  /// All of it, of the same bytes on every machine.
  std::string toBytes() const;
  /// Throws InputError saying what is wrong with the bytes.
  static FernDatabase fromBytes(const std::string& bytes);

 private:
  struct Fern {
    int pixel = 0;
    std::uint8_t color[3] = {};  ///< thresholds
    float depth_m = 0;
  };

  void store(std::int64_t id, const FernCode& code);

  FernConfig config_;
  std::vector<Fern> ferns_;
  std::vector<std::int64_t> ids_;
  std::vector<FernCode> codes_;
  std::vector<std::vector<std::uint32_t>> lists_;  ///< keyframes by 16 * fern + bits
};

}  // namespace pf

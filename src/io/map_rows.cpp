// SPDX-License-Identifier: BSD-3-Clause
#include "map_rows.hpp"

#include <cmath>
#include <limits>
#include <memory>

#include "map_encoding.hpp"
#include "map_schema.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

constexpr auto kLastKind = static_cast<std::int64_t>(ConstraintKind::reckoned);

int narrow(std::int64_t value, const char* name) {
  if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max()) {
    throw InputError(std::string(name) + " is " + std::to_string(value));
  }
  return static_cast<int>(value);
}

cv::Mat imageAt(const SqliteStatement& row, int column, int type, const cv::Size& largest) {
  cv::Mat image = decodePng(row.blob(column), largest);
  if (!image.empty() && image.type() == type) return image;
  throw InputError("an image of keyframe " + std::to_string(row.integer(0)) +
                   " is damaged, or larger than the camera's");
}

}  // namespace

void stateAt(const SqliteStatement& row, MapContent& content) {
  content.frame = narrow(row.integer(0), "the number of frames");
  if (content.frame < -1) throw InputError("the last frame is " + std::to_string(content.frame));
  content.graph_version = narrow(row.integer(1), "the version of the graph");
  content.brightness.gain = static_cast<float>(row.number(2));
  content.brightness.offset = static_cast<float>(row.number(3));
  content.settings = row.blob(4);
  content.camera.width = narrow(row.integer(5), "the width of the camera");
  content.camera.height = narrow(row.integer(6), "the height of the camera");
  decodeIntrinsics(row.blob(7), content.camera);
  validate(content.camera);
  if (!std::isfinite(content.brightness.gain) || !std::isfinite(content.brightness.offset)) {
    throw InputError("the brightness is not finite");
  }
}

const char* keyframeColumns(std::int64_t version) {
  return version < kRetiredVersion ? "id, fragment, stamp_ns, map_frame, t_map_camera, -1"
                                   : "id, fragment, stamp_ns, map_frame, t_map_camera, follows";
}

Keyframe keyframeAt(const SqliteStatement& row) {
  Keyframe k;
  k.id = narrow(row.integer(0), "a keyframe");
  k.fragment = narrow(row.integer(1), "a fragment");
  k.stamp_ns = row.integer(2);
  k.map_frame = narrow(row.integer(3), "the frame of a keyframe");
  k.T_map_camera = decodeTransform(row.blob(4));
  k.follows = narrow(row.integer(5), "what a keyframe follows");
  if (k.follows < -1) {
    throw InputError("keyframe " + std::to_string(k.id) + " follows " + std::to_string(k.follows));
  }
  return k;
}

PoseConstraint constraintAt(const SqliteStatement& row) {
  PoseConstraint c;
  const std::int64_t kind = row.integer(0);
  if (kind < 0 || kind > kLastKind) {
    throw InputError("a constraint is of kind " + std::to_string(kind) + ", expected 0 to " +
                     std::to_string(kLastKind));
  }
  c.kind = static_cast<ConstraintKind>(kind);
  c.from = narrow(row.integer(1), "the keyframe of a constraint");
  c.to = narrow(row.integer(2), "the keyframe of a constraint");
  c.T_from_to = decodeTransform(row.blob(3));
  c.covariance = decodeCovariance(row.blob(4));
  return c;
}

FrameRecord frameAt(const SqliteStatement& row) {
  FrameRecord frame;
  frame.stamp_ns = row.integer(0);
  frame.pose.keyframe = narrow(row.integer(1), "the keyframe of a frame");
  frame.pose.T_keyframe_camera = decodeTransform(row.blob(2));
  return frame;
}

const char* blockColumns(std::int64_t version) {
  return version < kFragmentsVersion ? "id, surfels, checksum, 0"
                                     : "id, surfels, checksum, fragment";
}

BlockRecord blockAt(const SqliteStatement& row, std::int64_t version, int last_frame) {
  const std::string name = "block " + std::to_string(row.integer(0));
  const std::string_view bytes = row.blob(1);
  if (checksumOf(bytes) != row.integer(2)) {
    throw InputError("is damaged: " + name + " does not have its checksum");
  }
  BlockRecord block;
  block.index = static_cast<std::uint32_t>(row.integer(0));
  block.fragment = narrow(row.integer(3), "the fragment of a block");
  if (block.fragment < 0) {
    throw InputError(name + " is of fragment " + std::to_string(block.fragment) +
                     ", expected 0 or more");
  }
  block.surfels = std::make_shared<const SurfelArrays>(decodeSurfels(bytes, version, last_frame));
  return block;
}

KeyframeImages imagesAt(const SqliteStatement& row, const cv::Size& camera) {
  KeyframeImages images;
  images.keyframe = narrow(row.integer(0), "the keyframe of an image");
  images.grey = imageAt(row, 1, CV_8UC1, camera);
  images.depth_mm = imageAt(row, 2, CV_16UC1, camera);
  if (images.grey.size() == images.depth_mm.size()) return images;
  throw InputError("the images of keyframe " + std::to_string(images.keyframe) +
                   " are not of one size");
}

}  // namespace pf

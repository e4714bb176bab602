// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <filesystem>
#include <limits>

#include "map_encoding.hpp"
#include "map_header.hpp"
#include "map_schema.hpp"
#include "map_upgrade.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/graph/pose_graph.hpp"
#include "posefusion/io/images.hpp"
#include "posefusion/io/map_database.hpp"
#include "sqlite.hpp"

namespace pf {
namespace {

int narrow(std::int64_t value, const char* name) {
  if (value < std::numeric_limits<int>::min() || value > std::numeric_limits<int>::max()) {
    throw InputError(std::string(name) + " is " + std::to_string(value));
  }
  return static_cast<int>(value);
}

int lastFrame(const SqliteDatabase& database) {
  const int frame = narrow(database.integer("SELECT frame FROM state"), "the number of frames");
  if (frame < -1) throw InputError("the last frame is " + std::to_string(frame));
  return frame;
}

void readState(const SqliteDatabase& database, MapContent& content) {
  SqliteStatement row = database.prepare(
      "SELECT graph_version, gain, offset, settings, width, height, intrinsics FROM state");
  if (!row.step()) throw InputError("holds no map yet: its writer ended before the first write");
  content.frame = lastFrame(database);
  content.graph_version = narrow(row.integer(0), "the version of the graph");
  content.brightness.gain = static_cast<float>(row.number(1));
  content.brightness.offset = static_cast<float>(row.number(2));
  content.settings = row.blob(3);
  content.camera.width = narrow(row.integer(4), "the width of the camera");
  content.camera.height = narrow(row.integer(5), "the height of the camera");
  decodeIntrinsics(row.blob(6), content.camera);
  validate(content.camera);
  if (!std::isfinite(content.brightness.gain) || !std::isfinite(content.brightness.offset)) {
    throw InputError("the brightness is not finite");
  }
}

void readKeyframes(const SqliteDatabase& database, MapContent& content) {
  SqliteStatement row = database.prepare(
      "SELECT id, fragment, stamp_ns, map_frame, t_map_camera FROM keyframes ORDER BY id");
  while (row.step()) {
    Keyframe k;
    k.id = narrow(row.integer(0), "a keyframe");
    k.fragment = narrow(row.integer(1), "a fragment");
    k.stamp_ns = row.integer(2);
    k.map_frame = narrow(row.integer(3), "the frame of a keyframe");
    k.T_map_camera = decodeTransform(row.blob(4));
    if (k.map_frame > content.frame) {
      throw InputError("keyframe " + std::to_string(k.id) + " is of frame " +
                       std::to_string(k.map_frame) + ", expected at most " +
                       std::to_string(content.frame));
    }
    content.keyframes.push_back(k);
  }
}

void readConstraints(const SqliteDatabase& database, MapContent& content) {
  SqliteStatement row = database.prepare(
      "SELECT kind, from_keyframe, to_keyframe, t_from_to, covariance FROM constraints ORDER BY "
      "id");
  while (row.step()) {
    PoseConstraint c;
    c.kind = row.integer(0) == 0 ? ConstraintKind::odometry : ConstraintKind::loop;
    c.from = narrow(row.integer(1), "the keyframe of a constraint");
    c.to = narrow(row.integer(2), "the keyframe of a constraint");
    c.T_from_to = decodeTransform(row.blob(3));
    c.covariance = decodeCovariance(row.blob(4));
    content.constraints.push_back(c);
  }
}

void readFrames(const SqliteDatabase& database, MapContent& content) {
  SqliteStatement row =
      database.prepare("SELECT stamp_ns, keyframe, t_keyframe_camera FROM frames ORDER BY id");
  while (row.step()) {
    FrameRecord frame;
    frame.stamp_ns = row.integer(0);
    frame.pose.keyframe = narrow(row.integer(1), "the keyframe of a frame");
    frame.pose.T_keyframe_camera = decodeTransform(row.blob(2));
    if (frame.pose.keyframe < 0 ||
        frame.pose.keyframe >= static_cast<int>(content.keyframes.size())) {
      throw InputError("a frame is kept relative to keyframe " +
                       std::to_string(frame.pose.keyframe) + ", expected one of " +
                       std::to_string(content.keyframes.size()));
    }
    content.frames.push_back(frame);
  }
}

cv::Mat readImage(std::string_view bytes, int type, const cv::Size& size, int keyframe) {
  cv::Mat image = decodeDepth(bytes.data(), bytes.size());
  if (image.type() == type && (size.empty() || image.size() == size)) return image;
  throw InputError("an image of keyframe " + std::to_string(keyframe) + " is damaged");
}

}  // namespace

struct MapReader::State {
  SqliteDatabase database;
  std::int64_t version = kMapVersion;

  /// What is wrong inside of the file, with its name.
  template <typename Read>
  auto named(const Read& read) const {
    try {
      return read();
    } catch (const InputError& error) {
      const std::string text = error.what(), name = database.path() + ": ";
      throw InputError(text.rfind(name, 0) == 0 ? text : name + text);
    }
  }
};

MapReader::MapReader(const std::string& path)
    : state_(new State{SqliteDatabase(path, SqliteDatabase::Access::read)}) {
  state_->version = checkMapFile(state_->database);
}

MapReader::~MapReader() = default;

MapContent MapReader::content() const {
  return state_->named([&] {
    const SqliteDatabase& database = state_->database;
    MapContent content;
    readState(database, content);
    readKeyframes(database, content);
    readConstraints(database, content);
    if (state_->version < kMapVersion) upgradeKeyframes(content.keyframes, content.constraints);
    readFrames(database, content);
    SqliteStatement row = database.prepare("SELECT name, data FROM blobs");
    while (row.step()) content.blobs.emplace(row.blob(0), row.blob(1));
    // The graph knows what it can take up.
    const PoseGraph check({}, content.keyframes, content.constraints, content.graph_version);
    return content;
  });
}

std::vector<FragmentSurfels> MapReader::surfels() const {
  return state_->named([&] {
    const int last_frame = lastFrame(state_->database);
    const bool is_old = state_->version < kMapVersion;
    std::vector<FragmentSurfels> parts;
    SqliteStatement row = state_->database.prepare(
        is_old ? "SELECT id, surfels, checksum, 0 FROM blocks ORDER BY id"
               : "SELECT id, surfels, checksum, fragment FROM blocks ORDER BY id");
    while (row.step()) {
      const std::string_view bytes = row.blob(1);
      if (checksumOf(bytes) != row.integer(2)) {
        throw InputError("is damaged: block " + std::to_string(row.integer(0)) +
                         " does not have its checksum");
      }
      const int fragment = narrow(row.integer(3), "the fragment of a block");
      if (fragment < 0) {
        throw InputError("block " + std::to_string(row.integer(0)) + " is of fragment " +
                         std::to_string(fragment) + ", expected 0 or more");
      }
      if (parts.empty() || parts.back().fragment != fragment) parts.push_back({fragment, {}});
      parts.back().surfels.append(decodeSurfels(bytes, last_frame));
    }
    if (!is_old || parts.empty()) return parts;
    return upgradeSurfels(parts.front().surfels, content().keyframes);
  });
}

KeyframeImages MapReader::images(int keyframe) const {
  return state_->named([&] {
    KeyframeImages images;
    images.keyframe = keyframe;
    SqliteStatement row =
        state_->database.prepare("SELECT grey, depth FROM images WHERE keyframe = ?1");
    row.bind(1, std::int64_t{keyframe});
    if (!row.step()) return images;
    images.grey = readImage(row.blob(0), CV_8UC1, {}, keyframe);
    images.depth_mm = readImage(row.blob(1), CV_16UC1, images.grey.size(), keyframe);
    return images;
  });
}

MapCounts MapReader::counts() const {
  const SqliteDatabase& d = state_->database;
  MapCounts counts;
  counts.blocks = static_cast<std::size_t>(d.integer("SELECT count(*) FROM blocks"));
  counts.surfels =
      static_cast<std::size_t>(d.integer("SELECT total(length(surfels)) FROM blocks")) /
      SurfelArrays::bytesPerSurfel();
  counts.images = static_cast<std::size_t>(d.integer("SELECT count(*) FROM images"));
  std::error_code ignored;
  counts.bytes = static_cast<std::size_t>(std::filesystem::file_size(d.path(), ignored));
  return counts;
}

}  // namespace pf

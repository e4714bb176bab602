// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include "map_header.hpp"
#include "map_rows.hpp"
#include "map_schema.hpp"
#include "map_upgrade.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/graph/pose_graph.hpp"
#include "posefusion/io/map_database.hpp"

namespace pf {
namespace {

SqliteStatement select(const SqliteDatabase& database, const std::string& columns,
                       const std::string& rest) {
  return database.prepare("SELECT " + columns + " FROM " + rest);
}

void readState(const SqliteDatabase& database, MapContent& content) {
  SqliteStatement row = select(database, kStateColumns, "state");
  if (!row.step()) throw InputError("holds no map yet: its writer ended before the first write");
  stateAt(row, content);
}

void readKeyframes(const SqliteDatabase& database, std::int64_t version, MapContent& content) {
  SqliteStatement row = select(database, keyframeColumns(version), "keyframes ORDER BY id");
  while (row.step()) {
    content.keyframes.push_back(keyframeAt(row));
    const Keyframe& k = content.keyframes.back();
    if (k.map_frame <= content.frame) continue;
    throw InputError("keyframe " + std::to_string(k.id) + " is of frame " +
                     std::to_string(k.map_frame) + ", expected at most " +
                     std::to_string(content.frame));
  }
}

void readFrames(const SqliteDatabase& database, MapContent& content) {
  SqliteStatement row = select(database, kFrameColumns, "frames ORDER BY id");
  const auto keyframes = static_cast<int>(content.keyframes.size());
  while (row.step()) {
    content.frames.push_back(frameAt(row));
    const int keyframe = content.frames.back().pose.keyframe;
    if (keyframe >= 0 && keyframe < keyframes) continue;
    throw InputError("a frame is kept relative to keyframe " + std::to_string(keyframe) +
                     ", expected one of " + std::to_string(keyframes));
  }
}

}  // namespace

struct MapReader::State {
  SqliteDatabase database;
  std::string missing{};
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

  MapContent state() const {
    MapContent content;
    readState(database, content);
    return content;
  }
};

MapReader::MapReader(const std::string& path) {
  const SqliteFiles files = lookAtFiles(path);  // opening it may make an empty log
  state_.reset(new State{SqliteDatabase(path, SqliteDatabase::Access::read)});
  state_->version = checkMapFile(state_->database);
  if (files.is_closed || files.has_log || isClosed(state_->database)) return;
  state_->missing = path + ": was not closed by its writer, and its log " + logOf(path) +
                    " is not there: what was mapped in the last second may be missing";
}

MapReader::~MapReader() = default;

MapContent MapReader::content() const {
  return state_->named([&] {
    const SqliteDatabase& database = state_->database;
    MapContent content = state_->state();
    readKeyframes(database, state_->version, content);
    SqliteStatement constraint = select(database, kConstraintColumns, "constraints ORDER BY id");
    while (constraint.step()) content.constraints.push_back(constraintAt(constraint));
    if (state_->version < kFragmentsVersion)
      upgradeKeyframes(content.keyframes, content.constraints);
    readFrames(database, content);
    SqliteStatement blob = database.prepare("SELECT name, data FROM blobs");
    while (blob.step()) content.blobs.emplace(blob.blob(0), blob.blob(1));
    content.blobs.erase(kClosedBlob);
    // The graph knows what it can take up.
    const PoseGraph check({}, content.keyframes, content.constraints, content.graph_version);
    return content;
  });
}

std::vector<FragmentSurfels> MapReader::surfels() const {
  return state_->named([&] {
    const int last_frame = state_->state().frame;
    std::vector<FragmentSurfels> parts;
    SqliteStatement row =
        select(state_->database, blockColumns(state_->version), "blocks ORDER BY id");
    while (row.step()) {
      const BlockRecord block = blockAt(row, state_->version, last_frame);
      if (parts.empty() || parts.back().fragment != block.fragment) {
        parts.push_back({block.fragment, {}});
      }
      parts.back().surfels.append(*block.surfels);
    }
    if (state_->version >= kFragmentsVersion || parts.empty()) return parts;
    return upgradeSurfels(parts.front().surfels, content().keyframes);
  });
}

KeyframeImages MapReader::images(int keyframe) const {
  return state_->named([&] {
    KeyframeImages images;
    images.keyframe = keyframe;
    SqliteStatement row = select(state_->database, kImageColumns, "images WHERE keyframe = ?1");
    row.bind(1, std::int64_t{keyframe});
    if (!row.step()) return images;
    const PinholeCamera camera = state_->state().camera;
    return imagesAt(row, {camera.width, camera.height});
  });
}

const std::string& MapReader::missing() const { return state_->missing; }

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

// SPDX-License-Identifier: BSD-3-Clause
#include "map_salvage.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>

#include "map_encoding.hpp"
#include "map_header.hpp"
#include "map_rows.hpp"
#include "map_schema.hpp"
#include "map_upgrade.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/graph/pose_graph.hpp"

namespace pf {
namespace {

// Of the tie between the neighbours of a lost keyframe: their poses are those of the graph, so that
// it holds the map together, and any measurement outweighs it.
constexpr double kBridge_m = 0.1, kBridge_rad = 0.05;

/// The keys of a table as far as they can be read, from both ends.
std::set<std::int64_t> keysOf(const SqliteDatabase& database, const std::string& table,
                              const std::string& key) {
  std::set<std::int64_t> keys;
  for (const char* order : {" ASC", " DESC"}) {
    try {
      SqliteStatement row =
          database.prepare("SELECT " + key + " FROM " + table + " ORDER BY " + key + order);
      while (row.step()) keys.insert(row.integer(0));
      break;  // all of them
    } catch (const InputError&) {
      // A damaged page: what lies behind it is reached from the other end.
    }
  }
  return keys;
}

/// Throws InputError unless the graph can take up these.
void check(std::vector<Keyframe> keyframes, std::vector<PoseConstraint> constraints = {}) {
  for (std::size_t i = 0; i < keyframes.size(); ++i) keyframes[i].id = static_cast<int>(i);
  const PoseGraph graph({}, std::move(keyframes), std::move(constraints), 0);
}

}  // namespace

void Salvage::forEachRow(const std::string& what, const std::string& table, const std::string& key,
                         const std::string& columns,
                         const std::function<void(std::int64_t, const SqliteStatement&)>& use) {
  std::size_t bad = 0;
  std::string first;
  for (const std::int64_t id : keysOf(database_, table, key)) {
    try {
      SqliteStatement row =
          database_.prepare("SELECT " + columns + " FROM " + table + " WHERE " + key + " = ?1");
      row.bind(1, id);
      if (!row.step()) throw InputError("row " + std::to_string(id) + " cannot be found");
      use(id, row);
    } catch (const InputError& error) {
      if (bad++ == 0) first = error.what();
    }
  }
  if (bad > 0) lost_.push_back(std::to_string(bad) + " " + what + " (the first: " + first + ")");
}

void Salvage::gatherState() {
  version_ = database_.integer("PRAGMA user_version");
  if (version_ < kFirstMapVersion || version_ > kMapVersion) {
    throw InputError("is of version " + std::to_string(version_) + ", expected " +
                     std::to_string(kFirstMapVersion) + " to " + std::to_string(kMapVersion));
  }
  SqliteStatement row = database_.prepare(std::string("SELECT ") + kStateColumns + " FROM state");
  if (!row.step()) throw InputError("holds no map yet: its writer ended before the first write");
  stateAt(row, found_);
}

void Salvage::gatherKeyframes() {
  std::int64_t expected = 0;
  forEachRow("keyframes", "keyframes", "id", keyframeColumns(version_),
             [&](std::int64_t id, const SqliteStatement& row) {
               Keyframe k = keyframeAt(row);
               k.id = static_cast<int>(found_.keyframes.size());
               Keyframe alone = k;
               alone.follows = -1;
               check({alone});
               if (id != expected) after_a_gap_.insert(k.id);
               expected = id + 1;
               numbers_[id] = k.id;
               found_.frame = std::max(found_.frame, k.map_frame);
               found_.keyframes.push_back(k);
             });
  if (found_.keyframes.empty()) throw InputError("no keyframe of it can be read");
  findCarriers();
  if (!after_a_gap_.empty()) {
    lost_.push_back("keyframes before " + std::to_string(after_a_gap_.size()) +
                    " of the others: tied over loosely");
  }
}

/// A retired keyframe whose carrier is lost is in use again.
void Salvage::findCarriers() {
  for (Keyframe& k : found_.keyframes) {
    if (!k.isRetired()) continue;
    const auto carrier = numbers_.find(k.follows);
    k.follows = -1;
    if (carrier == numbers_.end()) {
      after_a_gap_.insert(k.id);
      continue;
    }
    const Keyframe& found = found_.keyframes[static_cast<std::size_t>(carrier->second)];
    if (!found.isRetired() && found.fragment == k.fragment) k.follows = found.id;
  }
}

/// The keyframe itself, or the one that it follows.
int Salvage::inUse(int keyframe) const {
  const Keyframe& k = found_.keyframes[static_cast<std::size_t>(keyframe)];
  return k.isRetired() ? k.follows : keyframe;
}

int Salvage::newNumber(std::int64_t keyframe) const {
  const auto found = numbers_.find(keyframe);
  if (found == numbers_.end()) {
    throw InputError("hangs on keyframe " + std::to_string(keyframe) + ", which is lost");
  }
  return found->second;
}

void Salvage::gatherConstraints() {
  forEachRow("constraints", "constraints", "id", kConstraintColumns,
             [&](std::int64_t, const SqliteStatement& row) {
               PoseConstraint c = constraintAt(row);
               c.from = newNumber(c.from);
               c.to = newNumber(c.to);
               PoseConstraint alone = c;
               alone.from = 0;
               alone.to = c.from == c.to ? 0 : 1;
               check({Keyframe(), Keyframe()}, {alone});
               if (inUse(c.from) != c.from || inUse(c.to) != c.to) {
                 throw InputError("a constraint ends at a retired keyframe");
               }
               found_.constraints.push_back(c);
             });
  if (version_ < kFragmentsVersion) upgradeKeyframes(found_.keyframes, found_.constraints);
  bridgeGaps();
}

void Salvage::bridgeGaps() {
  for (const int to : after_a_gap_) {
    if (to == 0) continue;
    const Keyframe& before = found_.keyframes[static_cast<std::size_t>(inUse(to - 1))];
    const Keyframe& after = found_.keyframes[static_cast<std::size_t>(inUse(to))];
    if (before.fragment != after.fragment || before.id == after.id) continue;
    PoseConstraint bridge;
    bridge.kind = ConstraintKind::odometry;
    bridge.from = before.id;
    bridge.to = after.id;
    bridge.T_from_to = before.T_map_camera.inverse() * after.T_map_camera;
    bridge.covariance.diagonal().head<3>().setConstant(kBridge_m * kBridge_m);
    bridge.covariance.diagonal().tail<3>().setConstant(kBridge_rad * kBridge_rad);
    found_.constraints.push_back(bridge);
  }
}

void Salvage::gatherFrames() {
  forEachRow("poses of frames", "frames", "id", kFrameColumns,
             [&](std::int64_t, const SqliteStatement& row) {
               FrameRecord frame = frameAt(row);
               frame.pose.keyframe = newNumber(frame.pose.keyframe);
               found_.frames.push_back(frame);
             });
}

void Salvage::gatherBlocks() {
  SurfelArrays old;
  forEachRow("blocks of surfels", "blocks", "id", blockColumns(version_),
             [&](std::int64_t, const SqliteStatement& row) {
               BlockRecord block = blockAt(row, version_, std::numeric_limits<std::int32_t>::max());
               for (const auto* frames : {&block.surfels->seen, &block.surfels->created}) {
                 for (const std::int32_t frame : *frames) {
                   found_.frame = std::max(found_.frame, frame);
                 }
               }
               if (version_ < kFragmentsVersion) return old.append(*block.surfels);
               found_.blocks.push_back(std::move(block));
             });
  for (FragmentSurfels& part : upgradeSurfels(old, found_.keyframes)) {
    auto surfels = std::make_shared<const SurfelArrays>(std::move(part.surfels));
    found_.blocks.push_back({0, part.fragment, std::move(surfels)});
  }
  for (std::size_t i = 0; i < found_.blocks.size(); ++i) {
    found_.blocks[i].index = static_cast<std::uint32_t>(i);
  }
  found_.block_count = static_cast<std::uint32_t>(found_.blocks.size());
}

void Salvage::gatherImages() {
  const cv::Size camera(found_.camera.width, found_.camera.height);
  forEachRow("keyframes' images", "images", "keyframe", kImageColumns,
             [&](std::int64_t id, const SqliteStatement& row) {
               KeyframeImages images = imagesAt(row, camera);
               images.keyframe = newNumber(id);
               found_.images.push_back(std::move(images));
             });
}

void Salvage::gatherBlobs() {
  try {
    SqliteStatement row = database_.prepare("SELECT name, data FROM blobs");
    while (row.step()) {
      const std::string name(row.blob(0));
      constexpr std::string_view kOfKeyframe = kKeyframeBlobs;
      if (name == kClosedBlob) continue;
      if (name.rfind(kOfKeyframe, 0) != 0) {
        found_.blobs.emplace(name, row.blob(1));
        continue;
      }
      const auto number = numbers_.find(std::atoll(name.c_str() + kOfKeyframe.size()));
      if (number == numbers_.end()) continue;
      found_.blobs.emplace(keyframeBlob(number->second), row.blob(1));
    }
  } catch (const InputError& error) {
    lost_.push_back(std::string("some of what belongs to keyframes (") + error.what() + ")");
  }
}

MapUpdate Salvage::gather() {
  gatherState();
  gatherKeyframes();
  gatherConstraints();
  gatherFrames();
  gatherBlocks();
  gatherImages();
  gatherBlobs();
  return std::move(found_);
}

}  // namespace pf

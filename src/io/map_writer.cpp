// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "map_encoding.hpp"
#include "map_header.hpp"
#include "map_schema.hpp"
#include "map_upgrade.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/map_database.hpp"
#include "sqlite.hpp"

namespace pf {
namespace {

/// Makes the file, empty, so that two processes that create it cannot both succeed.
SqliteDatabase openNew(const std::string& path) {
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) throw InputError(path + ": cannot be made: " + std::strerror(errno));
  close(fd);
  std::error_code ignored;
  for (const char* companion : {"-wal", "-journal"}) {  // of a map of that name that was deleted
    std::filesystem::remove(path + companion, ignored);
  }
  return SqliteDatabase(path, SqliteDatabase::Access::write);
}

void setUp(const SqliteDatabase& database) {
  database.run("PRAGMA page_size=16384");  // blocks are large; counts for new files alone
  database.run("PRAGMA locking_mode=EXCLUSIVE");
  database.run("PRAGMA journal_mode=WAL");
  database.run("PRAGMA synchronous=NORMAL");  // a power cut may cost the last write, never the file
}

/// From the log into the file, as far as the disk has room; what has none stays in the log.
void emptyLog(const SqliteDatabase& database) {
  try {
    database.run("PRAGMA wal_checkpoint(PASSIVE)");
  } catch (const InputError&) {
    // Tried again after the next write.
  }
}

bool same(const Keyframe& a, const Keyframe& b) {
  return a.fragment == b.fragment && a.stamp_ns == b.stamp_ns && a.map_frame == b.map_frame &&
         a.follows == b.follows && a.T_map_camera.matrix() == b.T_map_camera.matrix();
}

bool same(const PoseConstraint& a, const PoseConstraint& b) {
  return a.from == b.from && a.to == b.to && a.kind == b.kind && a.covariance == b.covariance &&
         a.T_from_to.matrix() == b.T_from_to.matrix();
}

/// Writes the rows of a list that differ from those written before, by their places.
template <typename Row, typename Write>
void writeChanged(const std::vector<Row>& rows, const std::vector<Row>& written,
                  const Write& write) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i >= written.size() || !same(rows[i], written[i]))
      write(static_cast<std::int64_t>(i), rows[i]);
  }
}

void cutTable(const SqliteDatabase& database, const char* table, std::size_t rows) {
  database.run(std::string("DELETE FROM ") + table + " WHERE id >= " + std::to_string(rows));
}

void writeState(const SqliteDatabase& database, const MapUpdate& u) {
  SqliteStatement row =
      database.prepare("INSERT OR REPLACE INTO state VALUES(0, ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)");
  const std::string intrinsics = encodeIntrinsics(u.camera);
  row.bind(1, std::int64_t{u.frame});
  row.bind(2, std::int64_t{u.graph_version});
  row.bind(3, static_cast<double>(u.brightness.gain));
  row.bind(4, static_cast<double>(u.brightness.offset));
  row.bind(5, u.settings);
  row.bind(6, std::int64_t{u.camera.width});
  row.bind(7, std::int64_t{u.camera.height});
  row.bind(8, intrinsics);
  row.run();
}

void writeBlocks(const SqliteDatabase& database, const MapUpdate& update) {
  cutTable(database, "blocks", update.block_count);
  SqliteStatement row = database.prepare("INSERT OR REPLACE INTO blocks VALUES(?1, ?2, ?3, ?4)");
  for (const BlockRecord& block : update.blocks) {
    const std::string bytes = encode(*block.surfels);
    row.bind(1, std::int64_t{block.index});
    row.bind(2, std::int64_t{block.fragment});
    row.bind(3, bytes);
    row.bind(4, checksumOf(bytes));
    row.run();
  }
}

void dropPictures(const SqliteDatabase& database, std::int64_t keyframe) {
  const std::string id = std::to_string(keyframe);
  database.run("DELETE FROM images WHERE keyframe = " + id);
  database.run("DELETE FROM blobs WHERE name = '" + keyframeBlob(keyframe) + "'");
}

void writeKeyframes(const SqliteDatabase& database, const MapUpdate& update,
                    const std::vector<Keyframe>& written) {
  cutTable(database, "keyframes", update.keyframes.size());
  SqliteStatement row =
      database.prepare("INSERT OR REPLACE INTO keyframes VALUES(?1, ?2, ?3, ?4, ?5, ?6)");
  writeChanged(update.keyframes, written, [&](std::int64_t id, const Keyframe& k) {
    const std::string pose = encode(k.T_map_camera);
    row.bind(1, id);
    row.bind(2, std::int64_t{k.fragment});
    row.bind(3, k.stamp_ns);
    row.bind(4, std::int64_t{k.map_frame});
    row.bind(5, pose);
    row.bind(6, std::int64_t{k.follows});
    row.run();
    if (k.isRetired()) dropPictures(database, id);
  });
}

void writeConstraints(const SqliteDatabase& database, const MapUpdate& update,
                      const std::vector<PoseConstraint>& written) {
  cutTable(database, "constraints", update.constraints.size());
  SqliteStatement row =
      database.prepare("INSERT OR REPLACE INTO constraints VALUES(?1, ?2, ?3, ?4, ?5, ?6)");
  writeChanged(update.constraints, written, [&](std::int64_t id, const PoseConstraint& c) {
    const std::string motion = encode(c.T_from_to), covariance = encode(c.covariance);
    row.bind(1, id);
    row.bind(2, static_cast<std::int64_t>(c.kind));
    row.bind(3, std::int64_t{c.from});
    row.bind(4, std::int64_t{c.to});
    row.bind(5, motion);
    row.bind(6, covariance);
    row.run();
  });
}

void writeImages(const SqliteDatabase& database, const std::vector<KeyframeImages>& images) {
  SqliteStatement row = database.prepare("INSERT OR REPLACE INTO images VALUES(?1, ?2, ?3)");
  for (const KeyframeImages& of : images) {
    const std::string grey = encodePng(of.grey), depth = encodePng(of.depth_mm);
    row.bind(1, std::int64_t{of.keyframe});
    row.bind(2, grey);
    row.bind(3, depth);
    row.run();
  }
}

void writeFrames(const SqliteDatabase& database, const std::vector<FrameRecord>& frames) {
  std::int64_t next = database.integer("SELECT coalesce(max(id) + 1, 0) FROM frames");
  SqliteStatement row = database.prepare("INSERT INTO frames VALUES(?1, ?2, ?3, ?4)");
  for (const FrameRecord& frame : frames) {
    const std::string pose = encode(frame.pose.T_keyframe_camera);
    row.bind(1, next++);
    row.bind(2, frame.stamp_ns);
    row.bind(3, std::int64_t{frame.pose.keyframe});
    row.bind(4, pose);
    row.run();
  }
}

void writeBlobs(const SqliteDatabase& database, const std::map<std::string, std::string>& blobs) {
  SqliteStatement row =
      database.prepare("INSERT OR REPLACE INTO blobs VALUES(CAST(?1 AS TEXT), ?2)");
  for (const auto& [name, data] : blobs) {
    row.bind(1, name);
    row.bind(2, data);
    row.run();
  }
}

}  // namespace

std::vector<BlockRecord> changedBlocks(const SurfelMap& map, int since_frame) {
  std::vector<BlockRecord> records;
  for (std::size_t i = 0; i < map.blocks().size(); ++i) {
    const SurfelBlock& block = map.blocks()[i];
    if (block.changed < since_frame) continue;
    records.push_back({static_cast<std::uint32_t>(i), block.fragment, map.blocks().share(i)});
  }
  return records;
}

struct MapWriter::State {
  SqliteDatabase database;
  std::vector<Keyframe> keyframes;  // as written
  std::vector<PoseConstraint> constraints;
  bool is_old = false;  // of a version before: the first write brings all that differs
};

MapWriter::MapWriter(const std::string& path, Mode mode)
    : state_(new State{mode == Mode::create ? openNew(path)
                                            : SqliteDatabase(path, SqliteDatabase::Access::write),
                       {},
                       {},
                       false}) {
  if (mode == Mode::extend) state_->is_old = checkMapFile(state_->database) < kMapVersion;
  setUp(state_->database);
  if (mode == Mode::create) makeMapTables(state_->database);
  setClosed(state_->database, false);
  emptyLog(state_->database);
}

MapWriter::~MapWriter() {
  try {
    setClosed(state_->database, true);
    // Into the one file, which then can be read where nothing can be written.
    state_->database.run("PRAGMA journal_mode=DELETE");
  } catch (const InputError&) {
    // The companion file stays and is used when the map is next opened.
  }
}

void MapWriter::write(const MapUpdate& update) {
  const SqliteDatabase& database = state_->database;
  SqliteTransaction transaction(database);
  if (state_->is_old) upgradeTables(database);
  writeState(database, update);
  writeBlocks(database, update);
  writeKeyframes(database, update, state_->keyframes);
  writeConstraints(database, update, state_->constraints);
  writeImages(database, update.images);
  writeFrames(database, update.frames);
  writeBlobs(database, update.blobs);
  transaction.commit();
  state_->is_old = false;
  state_->keyframes = update.keyframes;
  state_->constraints = update.constraints;
  emptyLog(database);
}

void renameMapFile(const std::string& from, const std::string& to, IfThere other) {
  if (lookAtFiles(from).has_log) {
    throw InputError(from + ": was not closed, its log " + logOf(from) +
                     " cannot be written into it (disk full?): it keeps its name");
  }
  std::error_code error;
  for (const std::string& there : {to, logOf(to)}) {
    if (there == to && other == IfThere::replace) continue;
    if (std::filesystem::exists(std::filesystem::symlink_status(there, error))) {
      throw InputError(to + ": cannot be written: " + there + " is there already; the map is " +
                       from);
    }
  }
  std::filesystem::rename(from, to, error);
  if (error) throw InputError(to + ": cannot be written: " + error.message());
}

}  // namespace pf

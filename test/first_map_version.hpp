// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstring>
#include <map>
#include <string>

#include "../src/io/map_encoding.hpp"
#include "../src/io/sqlite.hpp"
#include "posefusion/core/static_odds.hpp"
#include "posefusion/map/surfels.hpp"

namespace pf {

/// Runs SQL on a file as another program would.
inline void runSql(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  char* error = nullptr;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
  sqlite3_close(database);
}

/// A block of surfels as version 3 kept it: frames that support it in place of the odds, and at the
/// end those that contradict it, here none.
inline std::string thirdVersionOf(std::string surfels) {
  constexpr std::size_t kOddsArray = 11;  // behind so many arrays of floats
  const std::size_t count = surfels.size() / SurfelArrays::bytesPerSurfel();
  for (std::size_t i = 0; i < count; ++i) {
    char* at = surfels.data() + (kOddsArray * count + i) * sizeof(float);
    float value = 0;
    std::memcpy(&value, at, sizeof value);
    value /= static_odds::kFrame;
    std::memcpy(at, &value, sizeof value);
  }
  return surfels.append(count * sizeof(std::int32_t), 0);
}

/// Gives a map file the blocks of version 3.
inline void makeThirdVersion(const std::string& path) {
  std::map<std::int64_t, std::string> blocks;
  {
    const SqliteDatabase database(path, SqliteDatabase::Access::read);
    SqliteStatement row = database.prepare("SELECT id, surfels FROM blocks");
    while (row.step()) blocks[row.integer(0)] = thirdVersionOf(std::string(row.blob(1)));
  }
  const SqliteDatabase database(path, SqliteDatabase::Access::write);
  for (const auto& [id, surfels] : blocks) {
    SqliteStatement row =
        database.prepare("UPDATE blocks SET surfels = ?2, checksum = ?3 WHERE id = ?1");
    row.bind(1, id);
    row.bind(2, surfels);
    row.bind(3, checksumOf(surfels));
    row.step();
  }
  database.run("PRAGMA user_version=3");
}

/// As above, with the tables of version 2, which had no retired keyframes. What they hold stays.
inline void makeSecondVersion(const std::string& path) {
  makeThirdVersion(path);
  runSql(path,
         "PRAGMA synchronous=OFF; ALTER TABLE keyframes RENAME TO others;"
         "CREATE TABLE keyframes(id INTEGER PRIMARY KEY, fragment INTEGER, stamp_ns INTEGER,"
         " map_frame INTEGER, t_map_camera BLOB);"
         "INSERT INTO keyframes SELECT id, fragment, stamp_ns, map_frame, t_map_camera FROM others;"
         "DROP TABLE others; PRAGMA user_version=2");
}

/// As above for version 1, whose blocks had no fragment either.
inline void makeFirstVersion(const std::string& path) {
  makeSecondVersion(path);
  runSql(path,
         "PRAGMA synchronous=OFF; ALTER TABLE blocks RENAME TO others;"
         "CREATE TABLE blocks(id INTEGER PRIMARY KEY, surfels BLOB, checksum INTEGER);"
         "INSERT INTO blocks SELECT id, surfels, checksum FROM others; DROP TABLE others;"
         "PRAGMA user_version=1");
}

}  // namespace pf

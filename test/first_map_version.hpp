// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <string>

namespace pf {

/// Runs SQL on a file as another program would.
inline void runSql(const std::string& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  char* error = nullptr;
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
  sqlite3_close(database);
}

/// Gives a map file the tables of version 2, which knew no retired keyframes. What they hold stays.
inline void makeSecondVersion(const std::string& path) {
  runSql(path,
         "PRAGMA synchronous=OFF; ALTER TABLE keyframes RENAME TO others;"
         "CREATE TABLE keyframes(id INTEGER PRIMARY KEY, fragment INTEGER, stamp_ns INTEGER,"
         " map_frame INTEGER, t_map_camera BLOB);"
         "INSERT INTO keyframes SELECT id, fragment, stamp_ns, map_frame, t_map_camera FROM others;"
         "DROP TABLE others; PRAGMA user_version=2");
}

/// The same of version 1, whose blocks had no fragment either.
inline void makeFirstVersion(const std::string& path) {
  makeSecondVersion(path);
  runSql(path,
         "PRAGMA synchronous=OFF; ALTER TABLE blocks RENAME TO others;"
         "CREATE TABLE blocks(id INTEGER PRIMARY KEY, surfels BLOB, checksum INTEGER);"
         "INSERT INTO blocks SELECT id, surfels, checksum FROM others; DROP TABLE others;"
         "PRAGMA user_version=1");
}

}  // namespace pf

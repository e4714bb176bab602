// SPDX-License-Identifier: BSD-3-Clause
#include "map_header.hpp"

#include <set>
#include <string>

#include "map_schema.hpp"
#include "posefusion/core/error.hpp"

namespace pf {
namespace {

void checkTables(const SqliteDatabase& database, std::int64_t version) {
  std::set<std::string> expected(kMapTables.begin(), kMapTables.end()), found;
  const auto had = [&](std::size_t table, const char* otherwise) {
    expected.erase(kMapTables[table]);
    expected.insert(otherwise);
  };
  if (version < kFragmentsVersion) had(kBlocksTable, kFirstBlocksTable);
  if (version < kRetiredVersion) had(kKeyframesTable, kFirstKeyframesTable);
  SqliteStatement rows = database.prepare("SELECT sql FROM sqlite_master");
  while (rows.step()) found.emplace(rows.blob(0));
  if (found != expected) throw InputError(database.path() + ": has other tables than a map");
}

void checkPages(const SqliteDatabase& database) {
  SqliteStatement rows = database.prepare("PRAGMA integrity_check(1)");
  const std::string answer = rows.step() ? std::string(rows.blob(0)) : "no answer";
  if (answer != "ok") throw InputError(database.path() + ": is damaged: " + answer);
}

}  // namespace

void setClosed(const SqliteDatabase& database, bool closed) {
  const std::string name = std::string("'") + kClosedBlob + "'";
  database.run(closed ? "INSERT OR REPLACE INTO blobs VALUES(" + name + ", x'01')"
                      : "DELETE FROM blobs WHERE name = " + name);
}

bool isClosed(const SqliteDatabase& database) {
  return database.integer(std::string("SELECT count(*) FROM blobs WHERE name = '") + kClosedBlob +
                          "'") > 0;
}

void makeMapTables(const SqliteDatabase& database) {
  const SqliteDatabase& d = database;
  SqliteTransaction transaction(d);
  d.run("PRAGMA application_id=" + std::to_string(kMapApplication));
  d.run("PRAGMA user_version=" + std::to_string(kMapVersion));
  for (const char* table : kMapTables) d.run(table);
  transaction.commit();
}

std::int64_t checkMapFile(const SqliteDatabase& database) {
  if (database.integer("PRAGMA application_id") != kMapApplication) {
    throw InputError(database.path() + ": is no map of posefusion");
  }
  const std::int64_t version = database.integer("PRAGMA user_version");
  if (version < kFirstMapVersion || version > kMapVersion) {
    throw InputError(database.path() + ": is a map of version " + std::to_string(version) +
                     ", expected " + std::to_string(kFirstMapVersion) + " to " +
                     std::to_string(kMapVersion) +
                     (version > kMapVersion ? ": a newer posefusion made it" : ""));
  }
  checkTables(database, version);
  checkPages(database);
  return version;
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "sqlite.hpp"

#include <sqlite3.h>

#include <filesystem>
#include <fstream>
#include <system_error>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

[[noreturn]] void fail(int code, sqlite3* database, const std::string& path) {
  const std::string said = database != nullptr ? sqlite3_errmsg(database) : sqlite3_errstr(code);
  switch (code & 0xFF) {
    case SQLITE_NOTADB:
      throw InputError(path + ": is no map of posefusion");
    case SQLITE_CORRUPT:
      throw InputError(path + ": is damaged: " + said);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw InputError(path + ": is in use by another process");
    case SQLITE_FULL:
    case SQLITE_IOERR:
      throw InputError(path + ": cannot be read or written: " + said);
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      throw InputError(path + ": cannot be opened: " + said);
    default:
      throw InputError(path + ": cannot be used as a map: " + said);
  }
}

int flagsOf(SqliteDatabase::Access access) {
  switch (access) {
    case SqliteDatabase::Access::read:
      return SQLITE_OPEN_READONLY;
    case SqliteDatabase::Access::write:
      return SQLITE_OPEN_READWRITE;
    default:
      return SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  }
}

}  // namespace

std::string logOf(const std::string& path) { return path + "-wal"; }

SqliteFiles lookAtFiles(const std::string& path) {
  // SQLite, "Database File Format", 1.3.3: byte 18 is 2 in a file that is written by way of a log.
  constexpr std::streamoff kWriteVersion = 18;
  SqliteFiles files;
  std::ifstream file(path, std::ios::binary);
  file.seekg(kWriteVersion);
  files.is_closed = file.get() == 1;
  std::error_code none;
  const auto bytes = std::filesystem::file_size(logOf(path), none);
  files.has_log = !none && bytes > 0;
  return files;
}

SqliteStatement::SqliteStatement(sqlite3* database, const std::string& path, const std::string& sql)
    : database_(database), path_(path), statement_(nullptr, sqlite3_finalize) {
  sqlite3_stmt* statement = nullptr;
  const int code =
      sqlite3_prepare_v2(database, sql.c_str(), static_cast<int>(sql.size()), &statement, nullptr);
  statement_.reset(statement);
  if (code != SQLITE_OK) fail(code, database_, path_);
}

void SqliteStatement::bind(int place, std::int64_t value) {
  const int code = sqlite3_bind_int64(statement_.get(), place, value);
  if (code != SQLITE_OK) fail(code, database_, path_);
}

void SqliteStatement::bind(int place, double value) {
  const int code = sqlite3_bind_double(statement_.get(), place, value);
  if (code != SQLITE_OK) fail(code, database_, path_);
}

void SqliteStatement::bind(int place, std::string_view blob) {
  const char* bytes = blob.empty() ? "" : blob.data();  // a null pointer would mean NULL
  const int code = sqlite3_bind_blob64(statement_.get(), place, bytes, blob.size(), SQLITE_STATIC);
  if (code != SQLITE_OK) fail(code, database_, path_);
}

bool SqliteStatement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) fail(code, database_, path_);
  return false;
}

void SqliteStatement::run() {
  step();
  sqlite3_reset(statement_.get());
}

std::int64_t SqliteStatement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double SqliteStatement::number(int column) const {
  return sqlite3_column_double(statement_.get(), column);
}

std::string_view SqliteStatement::blob(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return bytes == nullptr ? std::string_view()
                          : std::string_view(static_cast<const char*>(bytes), size);
}

SqliteDatabase::SqliteDatabase(const std::string& path, Access access)
    : path_(path), database_(nullptr, sqlite3_close_v2) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(path + ": is a folder, expected a map file");
  }
  // SQLite would write what the log of another file has over this one.
  const SqliteFiles files = lookAtFiles(path);
  if (files.is_closed && files.has_log) {
    throw InputError(path + ": the log " + logOf(path) +
                     " beside it is not its own, but of an earlier map of that name: move the log "
                     "away, or see 'posefusion_map repair'");
  }
  open(flagsOf(access));
  if (access == Access::read && files.has_log && !canBeRead()) openWithoutIndex();
}

void SqliteDatabase::open(int flags) {
  sqlite3* database = nullptr;
  const int code =
      sqlite3_open_v2(path_.c_str(), &database, flags | SQLITE_OPEN_FULLMUTEX, nullptr);
  database_.reset(database);
  if (code != SQLITE_OK) fail(code, database, path_);
  sqlite3_extended_result_codes(database, 1);
  // The file may come from anywhere: nothing in it may run or reach beyond the tables.
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
}

/// False where the index of the log, a third file, cannot be made: the disk is full.
bool SqliteDatabase::canBeRead() const {
  const int code =
      sqlite3_exec(database_.get(), "PRAGMA schema_version", nullptr, nullptr, nullptr);
  return (code & 0xFF) != SQLITE_IOERR && (code & 0xFF) != SQLITE_FULL;
}

/// The index of the log in memory, which one process alone may have; still nothing is written.
void SqliteDatabase::openWithoutIndex() {
  open(SQLITE_OPEN_READWRITE);
  sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  run("PRAGMA locking_mode=EXCLUSIVE");
  run("PRAGMA query_only=ON");
}

void SqliteDatabase::run(const std::string& sql) const {
  const int code = sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code, database_.get(), path_);
}

std::int64_t SqliteDatabase::integer(const std::string& sql) const {
  SqliteStatement statement = prepare(sql);
  return statement.step() ? statement.integer(0) : 0;
}

SqliteTransaction::~SqliteTransaction() {
  if (done_) return;
  try {
    database_.run("ROLLBACK");
  } catch (const InputError&) {
    // Already rolled back by the error that brought us here.
  }
}

}  // namespace pf

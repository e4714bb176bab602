// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace pf {

/// The file beside a database that holds what was written last, until it is closed.
std::string logOf(const std::string& path);

/// The files of a database on disk: states that SQLite itself does not distinguish.
struct SqliteFiles {
  bool is_closed = false;  ///< the file was closed: it has no log
  bool has_log = false;    ///< there is one, not empty
};
SqliteFiles lookAtFiles(const std::string& path);

/// A statement with its values (?1, ?2, ...) and the columns (from 0) of its current row.
class SqliteStatement {
 public:
  void bind(int place, std::int64_t value);
  void bind(int place, double value);
  /// The bytes must live until the statement is done.
  void bind(int place, std::string_view blob);

  /// To the next row; false when there is none. Throws InputError.
  bool step();
  /// Runs a statement without rows and makes it ready for other values.
  void run();

  std::int64_t integer(int column) const;
  double number(int column) const;
  /// Valid until the next step().
  std::string_view blob(int column) const;

 private:
  friend class SqliteDatabase;
  SqliteStatement(sqlite3* database, const std::string& path, const std::string& sql);

  sqlite3* database_;
  std::string path_;
  std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement_;
};

/// One connection to a database file. All errors are InputErrors naming the file.
class SqliteDatabase {
 public:
  enum class Access { read, write, create };

  /// Throws InputError naming the file, also where the log that lies beside it is not its own.
  SqliteDatabase(const std::string& path, Access access);

  SqliteStatement prepare(const std::string& sql) const { return {database_.get(), path_, sql}; }
  /// Runs statements without rows, or whose rows are not needed.
  void run(const std::string& sql) const;
  /// The first column of the first row.
  std::int64_t integer(const std::string& sql) const;
  const std::string& path() const { return path_; }

 private:
  void open(int flags);
  bool canBeRead() const;
  void openWithoutIndex();

  std::string path_;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_;
};

/// All that is written until commit(), or nothing.
class SqliteTransaction {
 public:
  explicit SqliteTransaction(const SqliteDatabase& database) : database_(database) {
    database_.run("BEGIN IMMEDIATE");
  }
  ~SqliteTransaction();
  SqliteTransaction(const SqliteTransaction&) = delete;
  SqliteTransaction& operator=(const SqliteTransaction&) = delete;

  void commit() {
    database_.run("COMMIT");
    done_ = true;
  }

 private:
  const SqliteDatabase& database_;
  bool done_ = false;
};

}  // namespace pf

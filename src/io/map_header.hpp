// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sqlite.hpp"

namespace pf {

/// Makes an empty database into an empty map file.
void makeMapTables(const SqliteDatabase& database);

/// Throws InputError naming the file unless it is a whole map file of a version that is known, with
/// exactly its tables. Returns the version.
std::int64_t checkMapFile(const SqliteDatabase& database);

/// Name of the blob that only a closed map has.
constexpr char kClosedBlob[] = "closed";

/// Notes in the file whether its writer has closed it. @{
void setClosed(const SqliteDatabase& database, bool closed);
bool isClosed(const SqliteDatabase& database);
/// @}

}  // namespace pf

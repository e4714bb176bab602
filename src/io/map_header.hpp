// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sqlite.hpp"

namespace pf {

/// Makes an empty database into an empty map file.
void makeMapTables(const SqliteDatabase& database);

/// Throws InputError naming the file unless it is a whole map file of a version that is known, with
/// exactly its tables. Returns the version.
std::int64_t checkMapFile(const SqliteDatabase& database);

}  // namespace pf

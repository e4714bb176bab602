// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "posefusion/io/map_database.hpp"
#include "sqlite.hpp"

namespace pf {

/// The content of a damaged file, gathered row by row.
class Salvage {
 public:
  explicit Salvage(const SqliteDatabase& database) : database_(database) {}

  /// Throws InputError where there is no camera or no keyframe.
  MapUpdate gather();

  /// What could not be read, a sentence each.
  const std::vector<std::string>& lost() const { return lost_; }

 private:
  /// Calls use(row) for each row of a table that can be read; counts and reports those that
  /// cannot, or of which `use` throws.
  void forEachRow(const std::string& what, const std::string& table, const std::string& key,
                  const std::string& columns,
                  const std::function<void(std::int64_t, const SqliteStatement&)>& use);

  void gatherState();
  void gatherKeyframes();
  void findCarriers();
  int inUse(int keyframe) const;
  void gatherConstraints();
  void bridgeGaps();
  void gatherFrames();
  void gatherBlocks();
  void gatherImages();
  void gatherBlobs();
  int newNumber(std::int64_t keyframe) const;

  const SqliteDatabase& database_;
  std::int64_t version_ = 0;
  MapUpdate found_;
  std::map<std::int64_t, int> numbers_;  ///< of the keyframes that are left: new by old
  std::set<int> after_a_gap_;            ///< keyframes (new) before which one is lost
  std::vector<std::string> lost_;
};

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "map_upgrade.hpp"

#include <algorithm>
#include <string>

#include "map_schema.hpp"

namespace pf {
namespace {

constexpr double kBetweenFragments_m = 500.0;  // along x

/// Keyframes by the frames that they were made of, and the fragment of each.
class FragmentOfFrame {
 public:
  explicit FragmentOfFrame(const std::vector<Keyframe>& keyframes) {
    for (const Keyframe& k : keyframes) begun_.emplace_back(k.map_frame, k.fragment);
    std::stable_sort(begun_.begin(), begun_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
  }

  int operator()(std::int32_t frame) const {
    const auto after = std::upper_bound(begun_.begin(), begun_.end(), frame,
                                        [](std::int32_t f, const auto& k) { return f < k.first; });
    if (begun_.empty()) return kFirstFragment;
    return after == begun_.begin() ? after->second : (after - 1)->second;
  }

 private:
  std::vector<std::pair<std::int32_t, int>> begun_;  // frame and fragment
};

}  // namespace

void upgradeKeyframes(std::vector<Keyframe>& keyframes,
                      const std::vector<PoseConstraint>& constraints) {
  std::vector<int> tracked_from(keyframes.size(), -1);
  const auto count = static_cast<int>(keyframes.size());
  for (const PoseConstraint& c : constraints) {
    const bool is_step = c.kind == ConstraintKind::odometry && c.from >= 0 && c.from < c.to;
    if (is_step && c.to < count) tracked_from[static_cast<std::size_t>(c.to)] = c.from;
  }
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    Keyframe& k = keyframes[i];
    if (tracked_from[i] >= 0) {
      k.fragment = keyframes[static_cast<std::size_t>(tracked_from[i])].fragment;
    }
    k.T_map_camera.translation().x() -= kBetweenFragments_m * k.fragment;
  }
}

std::vector<FragmentSurfels> upgradeSurfels(const SurfelArrays& surfels,
                                            const std::vector<Keyframe>& keyframes) {
  const FragmentOfFrame fragmentOf(keyframes);
  std::vector<FragmentSurfels> parts;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const int fragment = fragmentOf(surfels.created[i]);
    if (parts.empty() || parts.back().fragment != fragment) parts.push_back({fragment, {}});
    SurfelArrays& part = parts.back().surfels;
    const auto index = static_cast<std::uint32_t>(i);
    part.append(surfels, &index, 1);
    part.x.back() -= static_cast<float>(kBetweenFragments_m * fragment);
  }
  return parts;
}

void upgradeTables(const SqliteDatabase& database) {
  database.run("DROP TABLE blocks");
  database.run(kMapTables[kBlocksTable]);
  database.run("DROP TABLE keyframes");
  database.run(kMapTables[kKeyframesTable]);
  database.run("PRAGMA user_version=" + std::to_string(kMapVersion));
}

}  // namespace pf

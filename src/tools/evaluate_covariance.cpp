// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/covariance_check.hpp"
#include "posefusion/evaluation/nees.hpp"
#include "posefusion/io/status_file.hpp"
#include "posefusion/run/sequence_facts.hpp"

namespace pf {
namespace {

/// Windows of so many motions of a second.
constexpr std::size_t kShort = 1, kLong = 5;

nlohmann::ordered_json toJson(const NeesShare& nees) {
  return {{"windows", nees.windows}, {"low", nees.low},         {"high", nees.high},
          {"mean", nees.mean},       {"median", nees.median},   {"axes", nees.axes},
          {"inside", nees.inside},   {"too_low", nees.too_low}, {"too_high", nees.too_high}};
}

nlohmann::ordered_json toJson(const ProvisionalShare& share) {
  return {{"poses", share.poses},
          {"within_3_sigma", share.within},
          {"median_m", share.median_m},
          {"most_m", share.most_m},
          {"median_sigma_m", share.median_sigma_m}};
}

void printProvisional(const ProvisionalShare& share) {
  if (share.poses == 0) return;
  std::printf("provisional poses                  %zu, %.1f %% within 3 sigma on all six axes\n",
              share.poses, 100 * share.within);
  std::printf(
      "  error of their position          %.3f m median, %.3f m most; sigma %.3f m median\n",
      share.median_m, share.most_m, share.median_sigma_m);
}

void printNees(const char* what, const NeesShare& nees) {
  std::printf("%-34s %.1f %% of %zu windows within %.2f..%.2f; %.1f %% below, %.1f %% above\n",
              what, 100 * nees.inside, nees.windows, nees.low, nees.high, 100 * nees.too_low,
              100 * nees.too_high);
}

}  // namespace

void evaluateCovariance(const std::string& truth, const std::string& status, bool json) {
  std::vector<UncertainPose> poses, provisional;
  Trajectory known;
  for (const StatusRow& row : loadStatus(status)) {
    const UncertainPose pose{row.stamp_ns, row.T_map_camera, row.covariance};
    const bool is_good = row.outcome == "fused" || row.outcome == "located";
    if (row.is_provisional) provisional.push_back(pose);
    if (is_good && !row.is_provisional) poses.push_back(pose);
    if (row.has_pose) known.push_back({row.stamp_ns, row.T_map_camera});
  }
  const Trajectory true_poses = loadSequenceTruth(truth).trajectory;
  const CovarianceShare share = checkCovariances(true_poses, poses);
  const ProvisionalShare unsure = checkProvisional(true_poses, known, provisional);
  const NeesShare one = neesOfMotions(true_poses, poses, kShort);
  const NeesShare five = neesOfMotions(true_poses, poses, kLong);
  if (json) {
    const nlohmann::ordered_json out = {{"motions", share.motions},
                                        {"within_3_sigma", share.within},
                                        {"within_ellipsoid", share.within_ellipsoid},
                                        {"axes_within_3_sigma", share.axes},
                                        {"median_sigmas", share.median_sigmas},
                                        {"nees_1_s", toJson(one)},
                                        {"nees_5_s", toJson(five)},
                                        {"provisional", toJson(unsure)}};
    std::cout << out.dump(2) << "\n";
    return;
  }
  std::printf("motions from pose to pose          %zu\n", share.motions);
  std::printf("true error within 3 sigma          %.2f %% of them on all six axes\n",
              100 * share.within);
  std::printf("within the ellipsoid of 99.73 %%    %.2f %%\n", 100 * share.within_ellipsoid);
  std::printf("axes x y z, about x y z            ");
  for (const double axis : share.axes) std::printf(" %.2f", 100 * axis);
  std::printf(" %%\nlargest error in sigmas, median    %.2f\n", share.median_sigmas);
  std::printf("NEES of motions over a second      %.2f median, %.2f mean (5.35, 6 expected)\n",
              one.median, one.mean);
  std::printf("  median |error| by its sigma's    ");
  for (const double axis : one.axes) std::printf(" %.2f", axis);
  std::printf("  (1 expected)\n");
  printNees("  within its 95 % band", one);
  printNees("  mean of five within its band", five);
  printProvisional(unsure);
  std::printf("  below: errors smaller than reported (too cautious); above: larger (too sure)\n");
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/evaluation/covariance_check.hpp"
#include "posefusion/io/status_file.hpp"
#include "posefusion/run/sequence_facts.hpp"

namespace pf {

void evaluateCovariance(const std::string& truth, const std::string& status, bool json) {
  std::vector<UncertainPose> poses;
  for (const StatusRow& row : loadStatus(status)) {
    if (row.outcome == "fused" || row.outcome == "located")
      poses.push_back({row.stamp_ns, row.T_map_camera, row.covariance});
  }
  const CovarianceShare share = checkCovariances(loadSequenceTruth(truth).trajectory, poses);
  if (json) {
    const nlohmann::ordered_json out = {{"motions", share.motions},
                                        {"within_3_sigma", share.within},
                                        {"within_ellipsoid", share.within_ellipsoid},
                                        {"axes_within_3_sigma", share.axes},
                                        {"median_sigmas", share.median_sigmas}};
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
}

}  // namespace pf

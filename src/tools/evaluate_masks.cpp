// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <nlohmann/json.hpp>

#include "evaluate.hpp"
#include "posefusion/run/mask_folders.hpp"

namespace pf {
namespace {

void print(const char* title, const MaskScore& score) {
  if (score.frames == 0) {
    std::printf("%-36s none\n", title);
    return;
  }
  std::printf("%-36s IoU %.3f  recall %.3f  precision %.3f  (%d frames)\n", title, score.iou,
              score.recall, score.precision, score.frames);
}

nlohmann::json toJson(const MaskScore& score) {
  return {{"frames", score.frames},
          {"mean_iou", score.iou},
          {"mean_recall", score.recall},
          {"mean_precision", score.precision}};
}

}  // namespace

void evaluateMasks(const std::string& truth, const std::string& masks, bool json) {
  const MaskCheck check = checkMasks(truth, masks);
  if (json) {
    const nlohmann::json out = {{"found_people", toJson(check.found())},
                                {"frames_over_2_percent", toJson(check.crowded())},
                                {"falsely_masked_part", check.falseFraction()},
                                {"frames", check.frames()}};
    std::printf("%s\n", out.dump(2).c_str());
    return;
  }
  print("people found by the detector", check.found());
  print("frames with people over 2 % of pixels", check.crowded());
  std::printf("%-36s %.3f %% of pixels (%d frames)\n", "falsely masked",
              100 * check.falseFraction(), check.frames());
}

}  // namespace pf

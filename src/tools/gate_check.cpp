// SPDX-License-Identifier: BSD-3-Clause
// For the bench: how long the blur gate takes to get used to another scene. A recording is played
// to and fro at 30 Hz for three seconds, then it changes from one frame to the next for three more.
#include <algorithm>
#include <cstddef>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "posefusion/slam/pipeline.hpp"
#include "tool.hpp"

namespace pf {
namespace {

constexpr std::size_t kRate = 30, kBefore = 3 * kRate, kAfter = 3 * kRate, kRecorded = 45;
constexpr double kNormal = 0.9;  // share of the frames of a second that pass

using Change = std::function<cv::Mat(const cv::Mat&)>;

/// Seconds after the change until, for a second, at least kNormal of the frames pass; three if
/// never.
double secondsToNormal(const std::vector<RgbdFrame>& recorded, const Change& change) {
  Config config;
  config.pose.detector = "none";
  Pipeline pipeline(config, makePoseDetector(config.pose, {}));
  std::vector<bool> passed;
  for (std::size_t i = 0; i < kBefore + kAfter; ++i) {
    const std::size_t turn = 2 * recorded.size() - 2, phase = i % turn;
    RgbdFrame frame = recorded[phase < recorded.size() ? phase : turn - phase];
    frame.stamp_ns = static_cast<std::int64_t>(i) * 1'000'000'000 / static_cast<int>(kRate);
    if (i >= kBefore) frame.color = change(frame.color);
    const BlurScore blur = pipeline.see(frame).blur;
    if (i >= kBefore) passed.push_back(blur.sharp && !blur.forced);
  }
  for (std::size_t first = 0; first + kRate <= passed.size(); ++first) {
    const auto begin = passed.begin() + static_cast<std::ptrdiff_t>(first);
    const auto good = std::count(begin, begin + static_cast<std::ptrdiff_t>(kRate), true);
    if (static_cast<double>(good) >= kNormal * static_cast<double>(kRate)) {
      return static_cast<double>(first) / static_cast<double>(kRate);
    }
  }
  return static_cast<double>(kAfter) / static_cast<double>(kRate);
}

cv::Mat halveContrast(const cv::Mat& color) {
  cv::Mat halved;
  color.convertTo(halved, -1, 0.5, 32);
  return halved;
}

/// A wall that is all one colour, with the noise of the sensor alone: grey levels of 2.
cv::Mat dullWall(const cv::Mat& color) {
  static cv::RNG random(1);
  cv::Mat noise(color.size(), CV_16SC3), wall;
  random.fill(noise, cv::RNG::NORMAL, cv::Scalar::all(150), cv::Scalar::all(2));
  noise.convertTo(wall, CV_8UC3);
  return wall;
}

int gateCheck(const std::string& folder) {
  const auto recorded = readFrames(folder, 2, kRecorded);
  const nlohmann::ordered_json out = {
      {"contrast_halved_s", secondsToNormal(recorded, halveContrast)},
      {"dull_wall_s", secondsToNormal(recorded, dullWall)}};
  std::cout << out.dump(2) << "\n";
  return 0;
}

}  // namespace
}  // namespace pf

int main(int argc, char** argv) {
  pf::CommandLine app{"Seconds until the blur gate is used to another scene.",
                      "posefusion_gate_check"};
  std::string folder;
  app.addOption("sequence", folder, "TUM folder")->required();
  return pf::runTool(app, argc, argv, [&] { return pf::gateCheck(folder); });
}

// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that repeat: floors, walls, woods, cloths.
#include <cmath>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "simulator/random.hpp"
#include "simulator/texture.hpp"

namespace pf::simulator {
namespace {

constexpr int kSide = 512;

using Color = Eigen::Vector3f;  // sRGB, 0..255

struct Spot {
  float u, v;  // 0..1
  std::uint32_t seed, pixel;
};

cv::Mat paint(std::uint32_t seed, const std::function<Color(const Spot&)>& color) {
  cv::Mat picture(kSide, kSide, CV_8UC3);
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) {
      const auto pixel = static_cast<std::uint32_t>(row * kSide + col);
      const Spot spot{(col + 0.5F) / kSide, (row + 0.5F) / kSide, seed, hash(seed, pixel)};
      const Color c = color(spot);
      for (int k = 0; k < 3; ++k) {
        picture.at<cv::Vec3b>(row, col)[k] = cv::saturate_cast<std::uint8_t>(c[k]);
      }
    }
  }
  return picture;
}

float fractal(const Spot& s, int cells, int octaves, std::uint32_t salt) {
  return fractalNoise(s.u * cells, s.v * cells, hash(s.seed, salt), octaves, cells);
}

Color wood(const Spot& s) {
  constexpr int kPlanks = 5;
  const int plank = static_cast<int>(s.v * kPlanks);
  const std::uint32_t h = hash(s.seed, 7U, static_cast<std::uint32_t>(plank));
  const float along = s.u + uniform(h);
  const float across = s.v * kPlanks - plank;
  const float warp = fractalNoise(along * 4, s.v * 24, hash(s.seed, 1U), 4, 0);
  const float ring = 0.5F + 0.5F * std::sin(40.0F * (s.v + 0.06F * warp) + 9.0F * warp);
  const float fibre = fractalNoise(along * 12, s.v * 220, hash(s.seed, 2U), 3, 0);
  const float joint = across < 0.02F ? 0.55F : 1.0F;
  const float tone = (0.86F + 0.22F * uniform(hash(h, 3U)) - 0.14F * ring + 0.20F * fibre) * joint;
  return tone * Color(188, 148, 104);
}

Color board(const Spot& s) {
  const float warp = fractalNoise(s.u * 3, s.v * 10, hash(s.seed, 1U), 4, 0);
  const float fibre = fractalNoise(s.u * 10, s.v * 160, hash(s.seed, 2U), 3, 0);
  const float ring = 0.5F + 0.5F * std::sin(26.0F * (s.v + 0.10F * warp));
  return (0.95F - 0.10F * ring + 0.14F * fibre) * Color(205, 176, 138);
}

Color carpet(const Spot& s) {
  const float tuft = gaussian(hash(s.pixel, 5U));
  const float soil = fractal(s, 5, 5, 1U);
  const float loop = fractal(s, 128, 2, 2U);
  return (0.9F + 0.09F * tuft + 0.20F * soil + 0.30F * loop) * Color(118, 122, 132);
}

Color plaster(const Spot& s) {
  const float stain = fractal(s, 3, 6, 1U);
  const float grain = fractal(s, 96, 2, 2U);
  return (1.0F + 0.035F * stain + 0.035F * grain + 0.008F * gaussian(s.pixel)) *
         Color(226, 222, 212);
}

Color blank(const Spot& s) { return (1.0F + 0.008F * fractal(s, 2, 5, 1U)) * Color(232, 230, 225); }

Color concrete(const Spot& s) {
  const float cloud = fractal(s, 4, 7, 1U);
  const float pore = fractal(s, 60, 1, 2U) > 0.42F ? 0.72F : 1.0F;
  return (1.0F + 0.28F * cloud + 0.03F * gaussian(s.pixel)) * pore * Color(148, 146, 142);
}

Color tiles(const Spot& s) {
  constexpr int kTiles = 4;
  const float x = s.u * kTiles, y = s.v * kTiles;
  const auto col = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
  const float dx = std::min(x - col, col + 1 - x), dy = std::min(y - row, row + 1 - y);
  if (std::min(dx, dy) < 0.015F) return (1.0F + 0.1F * gaussian(s.pixel)) * Color(128, 124, 118);
  const float tone = 0.93F + 0.10F * uniform(hash(s.seed, col, row, 9U));
  const float vein = std::abs(fractal(s, 6, 6, 3U));
  return (tone + 0.16F * vein) * Color(188, 182, 172);
}

Color brick(const Spot& s) {
  const float y = s.v * 12;
  const auto row = static_cast<std::uint32_t>(y);
  const float x = s.u * 6 + (row % 2 ? 0.5F : 0.0F);
  const auto col = static_cast<std::uint32_t>(x) % 6U;
  const float dx = x - std::floor(x), dy = y - std::floor(y);
  const float rough = fractal(s, 40, 4, 2U);
  if (dx < 0.04F || dy < 0.09F) return (1.0F + 0.15F * rough) * Color(178, 170, 158);
  return (0.8F + 0.35F * uniform(hash(s.seed, col, row, 4U)) + 0.30F * rough) * Color(158, 88, 66);
}

Color cloth(const Spot& s) {
  const float weave = std::sin(s.u * 402.0F) * std::sin(s.v * 402.0F);
  return (0.95F + 0.06F * weave + 0.16F * fractal(s, 6, 6, 1U) + 0.05F * gaussian(s.pixel)) *
         Color(200, 200, 200);
}

Color denim(const Spot& s) {
  const float twill = std::sin((s.u + s.v) * 402.0F);
  const float worn = fractal(s, 4, 6, 1U);
  return (0.92F + 0.10F * twill + 0.40F * worn + 0.08F * gaussian(s.pixel)) * Color(190, 190, 190);
}

Color metal(const Spot& s) {
  return (0.95F + 0.05F * fractalNoise(s.u * 4, s.v * 200, s.seed, 3, 0)) * Color(176, 178, 182);
}

Color plastic(const Spot& s) {
  return (1.0F + 0.03F * fractal(s, 5, 6, 1U) + 0.015F * gaussian(s.pixel)) * Color(200, 200, 200);
}

Color leaves(const Spot& s) {
  const float vein = std::abs(fractal(s, 10, 5, 1U));
  return (0.7F + 1.2F * vein) * Color(66, 108, 52);
}

const std::map<std::string, std::pair<double, Color (*)(const Spot&)>>& surfaces() {
  static const std::map<std::string, std::pair<double, Color (*)(const Spot&)>> map = {
      {"wood", {1.2, wood}},       {"board", {1.4, board}}, {"carpet", {1.5, carpet}},
      {"plaster", {2.5, plaster}}, {"blank", {4.0, blank}}, {"concrete", {3.0, concrete}},
      {"tiles", {1.6, tiles}},     {"brick", {1.5, brick}}, {"cloth", {0.5, cloth}},
      {"denim", {0.4, denim}},     {"metal", {1.0, metal}}, {"plastic", {0.8, plastic}},
      {"leaves", {0.4, leaves}}};
  return map;
}

const std::vector<std::string>& prints() {
  static const std::vector<std::string> kinds = {"poster", "photo",  "books",      "screen",
                                                 "keys",   "carton", "whiteboard", "view",
                                                 "door",   "panel",  "paper"};
  return kinds;
}

}  // namespace

cv::Mat paintSurface(const std::string& kind, std::uint32_t seed) {
  const auto it = surfaces().find(kind);
  return it == surfaces().end() ? cv::Mat() : paint(seed, it->second.second);
}

double pictureSizeM(const std::string& kind) {
  const auto it = surfaces().find(kind);
  return it == surfaces().end() ? 0.0 : it->second.first;
}

std::vector<std::string> textureKinds() {
  std::vector<std::string> kinds = prints();
  for (const auto& entry : surfaces()) kinds.push_back(entry.first);
  return kinds;
}

}  // namespace pf::simulator

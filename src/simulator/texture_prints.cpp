// SPDX-License-Identifier: BSD-3-Clause
// Pictures that are stretched over one face: posters, screens, book spines, doors.
#include <algorithm>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "simulator/random.hpp"
#include "simulator/texture.hpp"

namespace pf::simulator {
namespace {

constexpr int kSheet = 512;

cv::Scalar someColor(Dice& dice, double darkest = 30, double brightest = 235) {
  // Printed things are rarely pure colours: half way to their own grey.
  const cv::Scalar pure(dice.between(darkest, brightest), dice.between(darkest, brightest),
                        dice.between(darkest, brightest));
  const double grey = (pure[0] + pure[1] + pure[2]) / 3.0, part = dice.between(0.25, 0.75);
  return {grey + part * (pure[0] - grey), grey + part * (pure[1] - grey),
          grey + part * (pure[2] - grey)};
}

cv::Mat sheet(const cv::Scalar& color) { return cv::Mat(kSheet, kSheet, CV_8UC3, color); }

void addGrain(cv::Mat& picture, std::uint32_t seed, double height) {
  for (int i = 0; i < kSheet * kSheet; ++i) {
    const float noise = gaussian(hash(seed, static_cast<std::uint32_t>(i)));
    auto& p = picture.at<cv::Vec3b>(i / kSheet, i % kSheet);
    for (int c = 0; c < 3; ++c) p[c] = cv::saturate_cast<std::uint8_t>(p[c] + height * noise);
  }
}

/// Lines of words as grey bars and letters.
void writeText(cv::Mat& picture, const cv::Rect& box, int line_height, Dice& dice) {
  const cv::Scalar ink(35, 35, 40);
  for (int y = box.y; y + line_height < box.br().y; y += line_height) {
    int x = box.x;
    const int end = box.x + static_cast<int>(box.width * dice.between(0.6, 1.0));
    while (x < end) {
      const int letters = 2 + dice.below(7);
      std::string word;
      for (int i = 0; i < letters; ++i) word += static_cast<char>('a' + dice.below(26));
      const double scale = line_height / 40.0;
      cv::putText(picture, word, {x, y + line_height * 2 / 3}, cv::FONT_HERSHEY_SIMPLEX, scale, ink,
                  line_height > 20 ? 2 : 1, cv::LINE_AA);
      x += static_cast<int>((letters + 1) * scale * 19);
    }
  }
}

/// A landscape-like picture: sky, hills of fractal outline, blobs.
void paintScenery(cv::Mat& picture, const cv::Rect& box, Dice& dice) {
  const double haze = dice.between(0.0, 40.0);
  const cv::Scalar sky(150 + haze, 185 + haze, 225), ground(70 + haze, 88 + haze, 50);
  const cv::Scalar hill = someColor(dice, 30, 190);
  const std::uint32_t seed = dice.next();
  for (int y = 0; y < box.height; ++y) {
    for (int x = 0; x < box.width; ++x) {
      const float u = static_cast<float>(x) / box.width, v = static_cast<float>(y) / box.height;
      const float ridge = 0.45F + 0.35F * fractalNoise(u * 3, 0.5F, seed, 5);
      const float coast = 0.75F + 0.20F * fractalNoise(u * 2, 3.5F, seed, 4);
      const cv::Scalar& base = v < ridge ? sky : v < coast ? hill : ground;
      const float shade = 1.0F + 0.45F * fractalNoise(u * 9, v * 9, seed + 9U, 5);
      auto& p = picture.at<cv::Vec3b>(box.y + y, box.x + x);
      for (int c = 0; c < 3; ++c) p[c] = cv::saturate_cast<std::uint8_t>(base[c] * shade);
    }
  }
  for (int i = 0; i < 4; ++i) {
    const cv::Point at(box.x + dice.below(box.width), box.y + dice.below(box.height));
    cv::circle(picture(box), at - box.tl(), 8 + dice.below(40), someColor(dice), -1, cv::LINE_AA);
  }
}

cv::Mat poster(Dice& dice) {
  cv::Mat picture = sheet(someColor(dice, 190, 250));
  cv::rectangle(picture, {0, 0, kSheet, 80}, someColor(dice, 20, 160), -1);
  writeText(picture, {24, 90, kSheet - 48, 60}, 44, dice);
  paintScenery(picture, {24, 160, 220, 150}, dice);
  paintScenery(picture, {268, 330, 220, 150}, dice);
  writeText(picture, {268, 160, 220, 160}, 16, dice);
  writeText(picture, {24, 330, 220, 160}, 16, dice);
  return picture;
}

cv::Mat photo(Dice& dice) {
  cv::Mat picture = sheet({30, 26, 22});
  paintScenery(picture, {22, 22, kSheet - 44, kSheet - 44}, dice);
  return picture;
}

cv::Mat books(Dice& dice) {
  cv::Mat picture = sheet({20, 18, 16});
  for (int x = 2; x < kSheet;) {
    const int width = 14 + dice.below(36), top = dice.below(150);
    const cv::Scalar color = someColor(dice, 20, 220);
    cv::rectangle(picture, {x, top, width, kSheet - top}, color, -1);
    cv::rectangle(picture, {x, top, 3, kSheet - top}, color * 0.6, -1);
    for (int band = 0; band < 3; ++band) {
      const int y = top + 20 + dice.below(kSheet - top - 40);
      cv::rectangle(picture, {x + 4, y, std::max(2, width - 8), 4 + dice.below(40)},
                    someColor(dice, 60, 250), -1);
    }
    x += width + 1 + (dice.chance(0.08) ? 30 : 0);
  }
  return picture;
}

cv::Mat screen(Dice& dice) {
  cv::Mat picture = sheet({24, 30, 44});
  paintScenery(picture, {0, 0, kSheet, kSheet}, dice);
  for (int i = 0; i < 3; ++i) {
    const cv::Rect box(20 + dice.below(200), 20 + dice.below(200), 240, 220);
    cv::rectangle(picture, box, {236, 238, 240}, -1);
    cv::rectangle(picture, {box.x, box.y, box.width, 22}, someColor(dice, 40, 150), -1);
    writeText(picture, {box.x + 8, box.y + 28, box.width - 16, box.height - 36}, 14, dice);
  }
  return picture;
}

cv::Mat keys(Dice&) {
  cv::Mat picture = sheet({28, 28, 30});
  for (int row = 0; row < 6; ++row) {
    for (int col = 0; col < 18; ++col) {
      cv::rectangle(picture, {12 + col * 27, 24 + row * 78, 23, 66}, {52, 52, 56}, -1);
      cv::rectangle(picture, {20 + col * 27, 40 + row * 78, 6, 16}, {170, 170, 170}, -1);
    }
  }
  return picture;
}

cv::Mat carton(Dice& dice) {
  cv::Mat picture = sheet({176, 138, 96});
  cv::rectangle(picture, {0, 236, kSheet, 40}, {198, 176, 132}, -1);
  cv::rectangle(picture, {300, 320, 150, 110}, {236, 234, 226}, -1);
  writeText(picture, {308, 324, 134, 100}, 18, dice);
  writeText(picture, {30, 60, 260, 90}, 60, dice);
  addGrain(picture, dice.next(), 5.0);
  return picture;
}

cv::Mat whiteboard(Dice& dice) {
  cv::Mat picture = sheet({238, 240, 242});
  const cv::Scalar pens[] = {{30, 40, 150}, {170, 30, 30}, {30, 120, 50}, {30, 30, 30}};
  for (int i = 0; i < 26; ++i) {
    const cv::Point a(20 + dice.below(470), 20 + dice.below(470));
    const cv::Point b(a.x + dice.below(160) - 80, a.y + dice.below(100) - 50);
    const cv::Scalar& pen = pens[dice.below(4)];
    if (i % 3 == 0) cv::rectangle(picture, a, b, pen, 2, cv::LINE_AA);
    if (i % 3 == 1) cv::line(picture, a, b, pen, 2, cv::LINE_AA);
    if (i % 3 == 2) cv::ellipse(picture, a, {20 + dice.below(40), 14}, 0, 0, 300, pen, 2);
  }
  return picture;
}

cv::Mat view(Dice& dice) {
  cv::Mat picture = sheet({232, 240, 250});
  for (int x = 0; x < kSheet;) {
    const int width = 50 + dice.below(90), top = 220 + dice.below(150);
    const cv::Scalar wall = someColor(dice, 150, 215);
    cv::rectangle(picture, {x, top, width, kSheet - top}, wall, -1);
    for (int y = top + 14; y < kSheet; y += 30) {
      for (int c = x + 8; c < x + width - 12; c += 22) {
        cv::rectangle(picture, {c, y, 11, 15}, wall * 0.55, -1);
      }
    }
    x += width;
  }
  cv::line(picture, {kSheet / 2, 0}, {kSheet / 2, kSheet}, {222, 222, 218}, 16);
  cv::line(picture, {0, kSheet / 3}, {kSheet, kSheet / 3}, {222, 222, 218}, 12);
  cv::rectangle(picture, {0, 0, kSheet, kSheet}, {222, 222, 218}, 26);
  return picture;
}

cv::Mat door(Dice& dice) {
  const double tone = dice.between(110, 190);
  const cv::Scalar base(tone * 1.08, tone, tone * dice.between(0.75, 0.95));
  cv::Mat picture = sheet(base);
  cv::rectangle(picture, {70, 40, 372, 190}, base * 0.86, 5);
  cv::rectangle(picture, {70, 270, 372, 200}, base * 0.86, 5);
  cv::rectangle(picture, {0, 0, kSheet, kSheet}, base * 0.7, 14);
  addGrain(picture, dice.next(), 4.0);
  return picture;
}

cv::Mat panel(Dice& dice) {
  cv::Mat picture = sheet({222, 222, 220});
  for (int i = 0; i <= 3; ++i) {
    cv::line(picture, {0, i * 170}, {kSheet, i * 170}, {120, 120, 122}, 5);
    if (i < 3) cv::rectangle(picture, {220, i * 170 + 30, 72, 12}, {90, 90, 92}, -1);
  }
  addGrain(picture, dice.next(), 3.0);
  return picture;
}

cv::Mat paper(Dice& dice) {
  cv::Mat picture = sheet({244, 244, 240});
  writeText(picture, {40, 40, 430, 440}, 22, dice);
  return picture;
}

}  // namespace

cv::Mat paintPrint(const std::string& kind, std::uint32_t seed) {
  static const std::map<std::string, std::function<cv::Mat(Dice&)>> painters = {
      {"poster", poster},         {"photo", photo}, {"books", books},
      {"screen", screen},         {"keys", keys},   {"carton", carton},
      {"whiteboard", whiteboard}, {"view", view},   {"door", door},
      {"panel", panel},           {"paper", paper}};
  const auto it = painters.find(kind);
  if (it == painters.end()) return {};
  Dice dice(hash(seed, 77U));
  return it->second(dice);
}

}  // namespace pf::simulator

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/shown_people.hpp"

#include <algorithm>
#include <cmath>

#include "posefusion/core/parallel.hpp"
#include "posefusion/pose/person_mask.hpp"

namespace pf {
namespace {

constexpr float kSure = 0.85F;  // probability
constexpr float kDenied = 0.25F;
constexpr float kMostFor = 4.0F, kMostAgainst = 1.5F;  // log-odds
constexpr float kMostAgainstUnshown = 0.3F;            // of people that the mask does not show
constexpr float kFloor = 0.004F;                       // of a probability: a step of the mask

/// Value between cells, the border repeated; pixel centres at integers.
float bilinear(const cv::Mat& bytes, const cv::Point2f& at) {
  const float x = std::clamp(at.x, 0.0F, static_cast<float>(bytes.cols - 1));
  const float y = std::clamp(at.y, 0.0F, static_cast<float>(bytes.rows - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, bytes.cols - 1), y1 = std::min(y0 + 1, bytes.rows - 1);
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const auto* upper = bytes.ptr<std::uint8_t>(y0);
  const auto* lower = bytes.ptr<std::uint8_t>(y1);
  return (1 - b) * ((1 - a) * upper[x0] + a * upper[x1]) +
         b * ((1 - a) * lower[x0] + a * lower[x1]);
}

/// The person of the cell itself, or of one beside it; -1: no person.
int personAt(const cv::Mat& owner, const cv::Point2f& at) {
  const int x0 = static_cast<int>(std::lround(at.x)), y0 = static_cast<int>(std::lround(at.y));
  if (x0 < 0 || y0 < 0 || x0 >= owner.cols || y0 >= owner.rows) return -1;
  const auto value = [&](int x, int y) {
    const bool inside = x >= 0 && y >= 0 && x < owner.cols && y < owner.rows;
    return inside ? static_cast<int>(owner.at<std::uint8_t>(y, x)) - 1 : -1;
  };
  for (const auto& [dx, dy] : {std::pair{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const int person = value(x0 + dx, y0 + dy);
    if (person >= 0) return person;
  }
  return -1;
}

}  // namespace

std::vector<int> ShownPeople::sureCells(int detection_index, const SceneGrid& grid) const {
  std::vector<int> cells;
  if (empty() || detection_index < 0) return cells;
  for (int cell = 0; cell < grid.size(); ++cell) {
    if (detection[cell] == detection_index && probability[cell] > kSure && grid.hasDepth(cell)) {
      cells.push_back(cell);
    }
  }
  return cells;
}

void sampleMask(const PersonMask& mask, const cv::Size& image, const SceneGrid& grid,
                ShownPeople& shown) {
  shown.probability.clear();
  shown.detection.clear();
  if (mask.empty()) return;
  shown.probability.resize(grid.size());
  shown.detection.resize(grid.size());
  const MaskGrid place(image);
  const float centre = 0.5F * static_cast<float>(grid.step - 1);
  parallelFor(grid.rows, kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      for (int col = 0; col < grid.cols; ++col) {
        const cv::Point2f at = place.toCell(static_cast<float>(col * grid.step) + centre,
                                            static_cast<float>(row * grid.step) + centre);
        const int cell = row * grid.cols + col;
        shown.probability[cell] = bilinear(mask.probability, at) / 255.0F;
        shown.detection[cell] = static_cast<std::int16_t>(personAt(mask.owner, at));
      }
    }
  });
}

bool isShown(const ShownPeople& shown, int cell) {
  return !shown.empty() && shown.probability[cell] > kSure;
}

bool isDenied(const ShownPeople& shown, int cell) {
  return !shown.empty() && shown.probability[cell] < kDenied;
}

float shownTerm(const ShownPeople& shown, int cell, bool is_shown) {
  if (shown.empty()) return 0.0F;
  const float p = std::clamp(shown.probability[cell], kFloor, 1.0F - kFloor);
  const float against = is_shown ? kMostAgainst : kMostAgainstUnshown;
  return std::clamp(std::log(p / (1.0F - p)), -against, kMostFor);
}

}  // namespace pf

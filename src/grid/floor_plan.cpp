// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/grid/floor_plan.hpp"

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "posefusion/core/error.hpp"

namespace pf {
namespace {

constexpr double kMargin_mm = 10, kLegend_mm = 16;
constexpr double kSmooth_cells = 0.75;   // steps of borders that lie across the grid become lines
constexpr double kLeastThing_m2 = 0.01;  // less is a speck
constexpr double kLeastWall_m = 0.15;    // a shorter line is a thing

/// From the frame of the floor to millimetres on paper, y down.
struct Paper {
  double mm_per_m = 20, left_m = 0, top_m = 0;

  double x(double x_m) const { return kMargin_mm + mm_per_m * (x_m - left_m); }
  double y(double y_m) const { return kMargin_mm + mm_per_m * (top_m - y_m); }
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return out;
}

/// All borders of a mask of cells, as one path to be filled by the even-odd rule. They lie on the
/// middles of cells: a line as wide as a cell belongs to the area.
std::string areaPath(const OccupancyGrid& grid, const cv::Mat& mask, const Paper& paper) {
  std::vector<std::vector<cv::Point>> borders;
  cv::findContours(mask.clone(), borders, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  std::string path;
  for (const auto& border : borders) {
    const double area_m2 = cv::contourArea(border) * grid.cell_m * grid.cell_m;
    if (area_m2 < kLeastThing_m2) continue;
    std::vector<cv::Point> smooth;
    cv::approxPolyDP(border, smooth, kSmooth_cells, true);
    char command = 'M';
    for (const cv::Point& p : smooth) {
      path += command + number(paper.x(grid.low_x_m + grid.cell_m * (p.x + 0.5))) + " " +
              number(paper.y(grid.low_y_m + grid.cell_m * (p.y + 0.5)));
      command = 'L';
    }
    path += "Z";
  }
  return path;
}

double lengthOf(const Outline& outline) {
  double length = 0;
  for (std::size_t i = 1; i < outline.size(); ++i) length += (outline[i] - outline[i - 1]).norm();
  return length;
}

std::string wallPath(const std::vector<Outline>& outlines, const Paper& paper) {
  std::string path;
  for (const Outline& outline : outlines) {
    if (lengthOf(outline) < kLeastWall_m) continue;
    std::vector<cv::Point2f> points, smooth;
    for (const auto& p : outline) points.emplace_back(p.x(), p.y());
    cv::approxPolyDP(points, smooth, 0.008, false);
    char command = 'M';
    for (const cv::Point2f& p : smooth) {
      path += command + number(paper.x(p.x)) + " " + number(paper.y(p.y));
      command = 'L';
    }
  }
  return path;
}

/// A bar of whole metres, and what the plan says of itself.
std::string legend(const PlanConfig& config, const Paper& paper, double width_mm, double top_mm) {
  const int metres =
      std::max(1, static_cast<int>((width_mm - 2 * kMargin_mm) / paper.mm_per_m / 3));
  std::string out;
  for (int i = 0; i < metres; ++i) {
    out += "<rect x=\"" + number(kMargin_mm + i * paper.mm_per_m) + "\" y=\"" + number(top_mm) +
           "\" width=\"" + number(paper.mm_per_m) + "\" height=\"1.5\" fill=\"" +
           (i % 2 == 0 ? "#222" : "#fff") + "\" stroke=\"#222\" stroke-width=\"0.2\"/>\n";
  }
  const std::string text = "<text font-family=\"sans-serif\" font-size=\"3.2\" fill=\"#222\" ";
  out += text + "x=\"" + number(kMargin_mm + metres * paper.mm_per_m + 2) + "\" y=\"" +
         number(top_mm + 2) + "\">" + std::to_string(metres) +
         " m, 1 : " + std::to_string(std::lround(config.scale)) + "</text>\n";
  return out + text + "x=\"" + number(kMargin_mm) + "\" y=\"" + number(top_mm + 7.5) + "\">" +
         escaped(config.title) + "</text>\n";
}

/// Of the cells that are known.
cv::Rect knownPart(const OccupancyGrid& grid) {
  const cv::Mat known = grid.cells != OccupancyGrid::kUnknown;
  if (cv::countNonZero(known) == 0) throw InputError("plan: nothing is known of the floor");
  return cv::boundingRect(known);
}

}  // namespace

void validate(const PlanConfig& config) {
  require(config.cut_m > 0 && config.cut_m <= 100, "plan: cut:", config.cut_m, "0 to 100 m");
  require(config.scale >= 1 && config.scale <= 10000, "plan: scale:", config.scale, "1 to 10000");
}

std::string floorPlan(const OccupancyGrid& grid, const TriangleMesh& mesh,
                      const PlanConfig& config) {
  validate(config);
  const cv::Rect part = knownPart(grid);
  Paper paper;
  paper.mm_per_m = 1000 / config.scale;
  paper.left_m = grid.low_x_m + grid.cell_m * part.x;
  paper.top_m = grid.low_y_m + grid.cell_m * part.br().y;
  const double mm_per_cell = paper.mm_per_m * grid.cell_m;
  const double width_mm = 2 * kMargin_mm + mm_per_cell * part.width;
  const double plan_mm = 2 * kMargin_mm + mm_per_cell * part.height;
  const std::string size = number(width_mm) + " " + number(plan_mm + kLegend_mm);
  const auto area = [&](std::int8_t state, bool equal, const char* color) {
    const cv::Mat mask = equal ? grid.cells == state : grid.cells != state;
    return "<path d=\"" + areaPath(grid, mask, paper) + "\" fill=\"" + color + "\" stroke=\"" +
           color + "\" stroke-width=\"" + number(mm_per_cell) +
           "\" stroke-linejoin=\"round\" fill-rule=\"evenodd\"/>\n";
  };
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(width_mm) +
         "mm\" height=\"" + number(plan_mm + kLegend_mm) + "mm\" viewBox=\"0 0 " + size +
         "\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         area(OccupancyGrid::kUnknown, false, "#f3efe6") +
         area(OccupancyGrid::kOccupied, true, "#c9c3b6") + "<path d=\"" +
         wallPath(cutLevel(mesh, static_cast<float>(config.cut_m)), paper) +
         "\" fill=\"none\" stroke=\"#222\" stroke-width=\"0.5\" stroke-linejoin=\"round\"/>\n" +
         legend(config, paper, width_mm, plan_mm) + "</svg>\n";
}

}  // namespace pf

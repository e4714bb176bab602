// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/io/grid_file.hpp"

#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "posefusion/config/yaml_map.hpp"
#include "posefusion/core/error.hpp"
#include "posefusion/io/files.hpp"
#include "posefusion/io/images.hpp"

namespace pf {
namespace {

namespace fs = std::filesystem;

constexpr int kFreePixel = 254, kOccupiedPixel = 0, kUnknownPixel = 205;

cv::Mat imageOf(const OccupancyGrid& grid) {
  cv::Mat image(grid.cells.size(), CV_8UC1, cv::Scalar(kUnknownPixel));
  image.setTo(kFreePixel, grid.cells == OccupancyGrid::kFree);
  image.setTo(kOccupiedPixel, grid.cells == OccupancyGrid::kOccupied);
  cv::flip(image, image, 0);
  return image;
}

void savePgm(const std::string& path, const cv::Mat& image) {
  AtomicFile file(path);
  file.stream() << "P5\n" << image.cols << " " << image.rows << "\n255\n";
  for (int y = 0; y < image.rows; ++y) {
    file.stream().write(image.ptr<char>(y), image.cols);
  }
  file.commit();
}

}  // namespace

void requireGridName(const std::string& path) { requireEnding(path, {".yaml"}); }

void saveGrid(const std::string& path, const OccupancyGrid& grid, bool png) {
  requireGridName(path);
  const fs::path image = fs::path(path).replace_extension(png ? ".png" : ".pgm");
  if (png) {
    savePng(image.string(), imageOf(grid));
  } else {
    savePgm(image.string(), imageOf(grid));
  }
  char text[300];
  std::snprintf(text, sizeof text,
                "resolution: %.9g\norigin: [%.9g, %.9g, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
                "free_thresh: 0.196\n",
                grid.cell_m, grid.low_x_m, grid.low_y_m);
  AtomicFile file(path);
  file.stream() << "image: " << image.filename().string() << "\n" << text;
  file.commit();
}

OccupancyGrid loadGrid(const std::string& path) {
  const YAML::Node node = parseYaml(readFile(path), path);
  OccupancyGrid grid;
  std::string name;
  try {
    name = node["image"].as<std::string>();
    grid.cell_m = node["resolution"].as<double>();
    grid.low_x_m = node["origin"][0].as<double>();
    grid.low_y_m = node["origin"][1].as<double>();
  } catch (const YAML::Exception& error) {
    throw InputError(path + ": expected image, resolution and origin of a grid: " + error.msg);
  }
  const std::string image_path = (fs::path(path).parent_path() / name).string();
  cv::Mat image = cv::imread(image_path, cv::IMREAD_GRAYSCALE);
  if (image.empty()) throw InputError(image_path + ": cannot be read, expected PGM or PNG");
  cv::flip(image, image, 0);
  grid.cells = cv::Mat(image.size(), CV_8SC1, cv::Scalar(OccupancyGrid::kUnknown));
  grid.cells.setTo(OccupancyGrid::kFree, image == kFreePixel);
  grid.cells.setTo(OccupancyGrid::kOccupied, image == kOccupiedPixel);
  return grid;
}

}  // namespace pf

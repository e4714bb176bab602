// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/planes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace pf {
namespace {

constexpr float kMaxPatchError = 0.004F;   // rms of a patch's own fit, 1/m
constexpr double kMinFilled = 0.7;         // of a patch's cells have depth
constexpr double kMinInverseDepth = 0.05;  // 1/m, of a patch whose size is measured

/// What counts as one plane.
struct PlaneLimits {
  int patch;        ///< cells along the side of a patch
  float tolerance;  ///< of inverse depth, 1/m
  int min_patches;
  double min_area_m2;  ///< as seen face on
  double min_side_m;   ///< of the box around it in the image: a strip of a body may be flat
  double max_error;    ///< rms of the fit to all of it, 1/m
};

// Larger than a back; 2.4 cm at 2 m.
constexpr PlaneLimits kLarge{8, 0.006F, 12, 0.35, 0.0, 1.0};
// Of simulated backs and chests this large none is so flat, of backs of chairs nearly all: what is
// left of those is the sensor's noise.
constexpr PlaneLimits kSmall{6, 0.003F, 8, 0.09, 0.25, 0.0023};

/// Sums from which a plane is fitted to inverse depths at (u, v), least squares.
struct Moments {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double square = 0;
  double count = 0;

  Moments& operator+=(const Moments& other) {
    A += other.A;
    b += other.b;
    square += other.square;
    count += other.count;
    return *this;
  }
  Eigen::Vector3d plane() const { return A.ldlt().solve(b); }
  double rms(const Eigen::Vector3d& p) const {
    return std::sqrt(std::max(0.0, (square - 2 * p.dot(b) + p.dot(A * p)) / count));
  }
};

struct Patch {
  Moments moments;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< u, v, 1
  double inverse_depth = 0;
  double error = std::numeric_limits<double>::max();  ///< rms of the fit, 1/m; no fit at first
};

}  // namespace

struct PlaneFinder::State {
  PlaneLimits limits = kLarge;
  int cols = 0, rows = 0;  ///< of patches
  std::vector<Patch> patches;
  std::vector<float> inverse_depth;   ///< of cells, 0 = none
  std::vector<int> order;             ///< patches, flattest first
  std::vector<std::uint8_t> taken;    ///< patches that belong to a region
  std::vector<int> members;           ///< patches of the region that grows
  Eigen::Vector3d plane;              ///< its plane
  std::vector<std::uint8_t> is_near;  ///< patches of the region and around it, see mark()

  void fitPatches(const SceneGrid& grid);
  Moments momentsOf(const cv::Rect& cells, int grid_cols) const;
  void fitPatch(const SceneGrid& grid, int index);
  void growRegion(int start);
  bool isPlane(const SceneGrid& grid) const;
  void mark(const SceneGrid& grid, Flatness flatness, std::vector<Flatness>& result);
  void markPatch(const SceneGrid& grid, int index, Flatness flatness,
                 std::vector<Flatness>& result) const;
  void find(const SceneGrid& grid, const PlaneLimits& wanted, Flatness flatness,
            std::vector<Flatness>& result);
};

PlaneFinder::PlaneFinder() : state_(std::make_unique<State>()) {}
PlaneFinder::~PlaneFinder() = default;

/// Of the cells that have depth.
Moments PlaneFinder::State::momentsOf(const cv::Rect& cells, int grid_cols) const {
  int count = 0, u_1 = 0, v_1 = 0, u_u = 0, u_v = 0, v_v = 0;
  double u_w = 0, v_w = 0, sum = 0, square = 0;
  for (int v = cells.y; v < cells.br().y; ++v) {
    const float* row = &inverse_depth[v * grid_cols];
    for (int u = cells.x; u < cells.br().x; ++u) {
      const double w = row[u];
      if (!(w > 0)) continue;
      ++count;
      u_1 += u;
      v_1 += v;
      u_u += u * u;
      u_v += u * v;
      v_v += v * v;
      u_w += u * w;
      v_w += v * w;
      sum += w;
      square += w * w;
    }
  }
  Moments moments;
  moments.A << u_u, u_v, u_1, u_v, v_v, v_1, u_1, v_1, count;
  moments.b << u_w, v_w, sum;
  moments.square = square;
  moments.count = count;
  return moments;
}

void PlaneFinder::State::fitPatch(const SceneGrid& grid, int index) {
  Patch& patch = patches[index];
  const int u0 = index % cols * limits.patch, v0 = index / cols * limits.patch;
  patch.moments = momentsOf(cv::Rect(u0, v0, limits.patch, limits.patch), grid.cols);
  if (patch.moments.count < kMinFilled * limits.patch * limits.patch) return;
  const Eigen::Vector3d fit = patch.moments.plane();
  patch.centre = {u0 + 0.5 * (limits.patch - 1), v0 + 0.5 * (limits.patch - 1), 1.0};
  patch.inverse_depth = fit.dot(patch.centre);
  patch.error = patch.moments.rms(fit);
}

void PlaneFinder::State::fitPatches(const SceneGrid& grid) {
  cols = grid.cols / limits.patch;
  rows = grid.rows / limits.patch;
  inverse_depth.resize(grid.size());
  for (int cell = 0; cell < grid.size(); ++cell) {
    inverse_depth[cell] = grid.hasDepth(cell) ? 1.0F / grid.z[cell] : 0.0F;
  }
  patches.assign(cols * rows, Patch());
  for (int index = 0; index < cols * rows; ++index) fitPatch(grid, index);
  order.resize(patches.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [this](int a, int b) {
    return std::make_pair(patches[a].error, a) < std::make_pair(patches[b].error, b);
  });
  taken.assign(patches.size(), 0);
}

void PlaneFinder::State::growRegion(int start) {
  members.assign(1, start);
  taken[start] = 1;
  Moments sum = patches[start].moments;
  plane = sum.plane();
  for (std::size_t next = 0; next < members.size(); ++next) {
    for (const auto& [right, down] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int col = members[next] % cols + right, row = members[next] / cols + down;
      if (col < 0 || row < 0 || col >= cols || row >= rows) continue;
      const int index = row * cols + col;
      const Patch& patch = patches[index];
      if (taken[index] != 0 || patch.error > kMaxPatchError) continue;
      if (std::abs(plane.dot(patch.centre) - patch.inverse_depth) > limits.tolerance) continue;
      taken[index] = 1;
      members.push_back(index);
      sum += patch.moments;
      plane = sum.plane();
    }
  }
}

bool PlaneFinder::State::isPlane(const SceneGrid& grid) const {
  if (static_cast<int>(members.size()) < limits.min_patches) return false;
  Moments sum;
  double area_m2 = 0, side_m = 0;
  int left = cols, right = 0, top = rows, bottom = 0;
  for (int index : members) {
    sum += patches[index].moments;
    side_m = limits.patch * grid.spacing / std::max(kMinInverseDepth, patches[index].inverse_depth);
    area_m2 += side_m * side_m;
    left = std::min(left, index % cols);
    right = std::max(right, index % cols);
    top = std::min(top, index / cols);
    bottom = std::max(bottom, index / cols);
  }
  const double least_side_m = side_m * (1 + std::min(right - left, bottom - top));
  return area_m2 > limits.min_area_m2 && least_side_m > limits.min_side_m &&
         sum.rms(plane) < limits.max_error;
}

/// Marks the cells of the plane in the patches of its region and in those around them: the border
/// patches of a region mix two surfaces and did not join.
void PlaneFinder::State::mark(const SceneGrid& grid, Flatness flatness,
                              std::vector<Flatness>& result) {
  const cv::Size size(cols + 1, rows + 1);  // the last ones have what is left of the grid
  is_near.assign(size.area(), 0);
  for (int index : members) {
    const cv::Point at(index % cols, index / cols);
    const cv::Rect around = cv::Rect(at.x - 1, at.y - 1, 3, 3) & cv::Rect({0, 0}, size);
    cv::Mat(size, CV_8UC1, is_near.data())(around).setTo(1);
  }
  for (int index = 0; index < size.area(); ++index) {
    if (is_near[index] != 0) markPatch(grid, index, flatness, result);
  }
}

void PlaneFinder::State::markPatch(const SceneGrid& grid, int index, Flatness flatness,
                                   std::vector<Flatness>& result) const {
  const int u0 = index % (cols + 1) * limits.patch, v0 = index / (cols + 1) * limits.patch;
  for (int v = v0; v < std::min(grid.rows, v0 + limits.patch); ++v) {
    for (int u = u0; u < std::min(grid.cols, u0 + limits.patch); ++u) {
      const int cell = v * grid.cols + u;
      const double predicted = plane.x() * u + plane.y() * v + plane.z();
      if (inverse_depth[cell] > 0.0F &&
          std::abs(predicted - inverse_depth[cell]) < limits.tolerance) {
        result[cell] = flatness;
      }
    }
  }
}

void PlaneFinder::State::find(const SceneGrid& grid, const PlaneLimits& wanted, Flatness flatness,
                              std::vector<Flatness>& result) {
  limits = wanted;
  fitPatches(grid);
  for (int start : order) {
    if (taken[start] != 0 || patches[start].error > kMaxPatchError) continue;
    growRegion(start);
    if (isPlane(grid)) mark(grid, flatness, result);
  }
}

void PlaneFinder::find(const SceneGrid& grid, std::vector<Flatness>& result) {
  result.assign(grid.size(), Flatness::none);
  state_->find(grid, kSmall, Flatness::small, result);
  state_->find(grid, kLarge, Flatness::large, result);
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/loop/features.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <random>

#include "bytes.hpp"
#include "posefusion/core/se3.hpp"

namespace pf {
namespace {

constexpr float kRatio = 0.8F;
constexpr int kLeastInliers = 12;
constexpr int kTries = 400;
constexpr float kSigmas = 3.0F;
constexpr double kLateralSigmas = 4.0;
constexpr double kLeastSide_m = 0.15;  // of a triangle: smaller ones give no rotation
constexpr std::uint32_t kFeaturesMagic = 0x54464650, kFeaturesVersion = 1;  // "PFFT"

using Pairs = std::vector<std::pair<int, int>>;

/// For each row of `a` the nearest of `b` when it is much nearer than the second, else -1.
std::vector<int> nearestRows(const cv::Mat& a, const cv::Mat& b) {
  std::vector<std::vector<cv::DMatch>> matches;
  cv::BFMatcher(cv::NORM_L2).knnMatch(a, b, matches, 2);
  std::vector<int> nearest(static_cast<std::size_t>(a.rows), -1);
  for (const auto& two : matches) {
    if (two.size() < 2 || two[0].distance >= kRatio * two[1].distance) continue;
    nearest[static_cast<std::size_t>(two[0].queryIdx)] = two[0].trainIdx;
  }
  return nearest;
}

Pairs mutualPairs(const Features& first, const Features& second) {
  cv::Mat a, b;
  first.descriptors.convertTo(a, CV_32F);
  second.descriptors.convertTo(b, CV_32F);
  const std::vector<int> forth = nearestRows(a, b), back = nearestRows(b, a);
  Pairs pairs;
  for (std::size_t i = 0; i < forth.size(); ++i) {
    const int j = forth[i];
    if (j >= 0 && back[static_cast<std::size_t>(j)] == static_cast<int>(i)) {
      pairs.emplace_back(static_cast<int>(i), j);
    }
  }
  return pairs;
}

/// The points of the pairs, column by column.
struct Points {
  Eigen::Matrix3Xd first, second;
  std::vector<double> tolerance_m;
};

Points pointsOf(const Pairs& pairs, const Features& first, const Features& second,
                const DepthSensor& sensor) {
  Points p;
  p.first.resize(3, static_cast<Eigen::Index>(pairs.size()));
  p.second.resize(3, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto& a = first.points[static_cast<std::size_t>(pairs[k].first)];
    const auto& b = second.points[static_cast<std::size_t>(pairs[k].second)];
    p.first.col(static_cast<Eigen::Index>(k)) = a.cast<double>();
    p.second.col(static_cast<Eigen::Index>(k)) = b.cast<double>();
    const float z = std::max(a.z(), b.z());
    p.tolerance_m.push_back(sensor.tolerance(z, kSigmas) + kLateralSigmas * sensor.lateral_rad * z);
  }
  return p;
}

/// The motion that best takes the second points to the first, of the columns named.
Eigen::Isometry3d fit(const Points& p, const std::vector<int>& columns) {
  Eigen::Matrix3Xd a(3, columns.size()), b(3, columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    a.col(static_cast<Eigen::Index>(k)) = p.first.col(columns[k]);
    b.col(static_cast<Eigen::Index>(k)) = p.second.col(columns[k]);
  }
  Eigen::Isometry3d T;
  T.matrix() = Eigen::umeyama(b, a, false);
  return T;
}

std::vector<int> inliersOf(const Points& p, const Eigen::Isometry3d& T) {
  std::vector<int> inliers;
  for (Eigen::Index k = 0; k < p.first.cols(); ++k) {
    const double off_m = (p.first.col(k) - T * p.second.col(k)).norm();
    if (off_m < p.tolerance_m[static_cast<std::size_t>(k)]) inliers.push_back(static_cast<int>(k));
  }
  return inliers;
}

/// Are the triangles of three pairs large and of the same shape?
bool isUsable(const Points& p, const std::vector<int>& three) {
  for (std::size_t k = 0; k < 3; ++k) {
    const int i = three[k], j = three[(k + 1) % 3];
    if (i == j) return false;
    const double a = (p.first.col(i) - p.first.col(j)).norm();
    const double b = (p.second.col(i) - p.second.col(j)).norm();
    const double most =
        p.tolerance_m[static_cast<std::size_t>(i)] + p.tolerance_m[static_cast<std::size_t>(j)];
    if (a < kLeastSide_m || std::abs(a - b) > most) return false;
  }
  return true;
}

}  // namespace

Features findFeatures(const FeatureImage& image, int most) {
  std::vector<cv::KeyPoint> corners;
  const cv::Mat known = image.depth_m > 0;
  const auto sift = cv::SIFT::create(most, 3, 0.02, 10, 1.6, CV_8U);
  Features features;
  sift->detectAndCompute(image.intensity, known, corners, features.descriptors);
  for (const cv::KeyPoint& corner : corners) {
    const int u = std::clamp(cvRound(corner.pt.x), 0, image.depth_m.cols - 1);
    const int v = std::clamp(cvRound(corner.pt.y), 0, image.depth_m.rows - 1);
    const float depth = image.depth_m.at<float>(v, u);
    // The mask is read at another rounding: a corner beside a hole has no place.
    features.points.push_back(
        image.camera.unproject(corner.pt.x, corner.pt.y, depth).cast<float>());
  }
  Features placed;
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (!(features.points[i].z() > 0)) continue;
    placed.points.push_back(features.points[i]);
    placed.descriptors.push_back(features.descriptors.row(static_cast<int>(i)));
  }
  return placed;
}

FeatureMatch matchFeatures(const Features& first, const Features& second,
                           const DepthSensor& sensor) {
  FeatureMatch match;
  if (first.size() < 2 || second.size() < 2) return match;
  const Pairs pairs = mutualPairs(first, second);
  match.matches = static_cast<int>(pairs.size());
  if (match.matches < kLeastInliers) return match;
  const Points points = pointsOf(pairs, first, second, sensor);
  std::mt19937 random(1);
  const auto count = static_cast<std::uint32_t>(pairs.size());
  std::vector<int> best;
  for (int i = 0; i < kTries; ++i) {
    std::vector<int> three(3);
    for (int& k : three) k = static_cast<int>(random() % count);
    if (!isUsable(points, three)) continue;
    std::vector<int> inliers = inliersOf(points, fit(points, three));
    if (inliers.size() > best.size()) best = std::move(inliers);
  }
  for (int i = 0; i < 3 && best.size() >= 3; ++i) {
    match.T_first_second = fit(points, best);
    best = inliersOf(points, match.T_first_second);
  }
  match.inliers = static_cast<int>(best.size());
  match.found = match.inliers >= kLeastInliers && match.T_first_second.matrix().allFinite();
  return match;
}

std::string toBytes(const Features& features) {
  ByteWriter out;
  out.put(kFeaturesMagic);
  out.put(kFeaturesVersion);
  out.put(static_cast<std::uint32_t>(features.size()));
  for (std::size_t i = 0; i < features.size(); ++i) {
    for (int k = 0; k < 3; ++k) out.put(features.points[i][k]);
    out.append(features.descriptors.ptr(static_cast<int>(i)), Features::kDescriptor);
  }
  return out.bytes();
}

Features featuresFromBytes(const std::string& bytes) {
  ByteReader in(bytes, "features");
  in.expect(kFeaturesMagic, kFeaturesVersion);
  const auto count = in.get<std::uint32_t>();
  constexpr std::size_t kEach = 3 * sizeof(float) + Features::kDescriptor;
  if (in.left() != count * kEach) in.fail("has not the size that it states");
  Features features;
  features.descriptors.create(static_cast<int>(count), Features::kDescriptor, CV_8UC1);
  for (std::uint32_t i = 0; i < count; ++i) {
    Eigen::Vector3f point;
    for (int k = 0; k < 3; ++k) point[k] = in.get<float>();
    if (!point.allFinite() || !(point.z() > 0)) in.fail("a point is not before the camera");
    features.points.push_back(point);
    in.read(features.descriptors.ptr(static_cast<int>(i)), Features::kDescriptor);
  }
  return features;
}

}  // namespace pf

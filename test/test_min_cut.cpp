// SPDX-License-Identifier: BSD-3-Clause
// The paper's terms cut a small cloud as PCL's MinCutSegmentation does.
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/min_cut_segmentation.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "posefusion/segmentation/energy.hpp"
#include "posefusion/segmentation/graph_cut.hpp"

namespace pf {
namespace {

constexpr float kSigma = 0.25F;
constexpr float kRadius = 0.20F;
constexpr int kNeighbours = 14;

/// A ball of points before a sparse wall.
std::vector<Eigen::Vector3f> makeCloud(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> ball(0.0F, 0.08F);
  std::uniform_real_distribution<float> wall(-1.0F, 1.0F);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 150; ++i)
    points.emplace_back(ball(random), ball(random), 1.5F + ball(random));
  for (int i = 0; i < 250; ++i) {
    points.emplace_back(wall(random), wall(random), 2.5F + 0.05F * wall(random));
  }
  return points;
}

struct PclCut {
  std::vector<bool> person;
  double max_flow = 0;  ///< the cost of the cheapest cut
};

PclCut cutByPcl(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& seed) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  for (const auto& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  pcl::PointCloud<pcl::PointXYZ>::Ptr seeds(new pcl::PointCloud<pcl::PointXYZ>);
  seeds->emplace_back(seed.x(), seed.y(), seed.z());
  pcl::MinCutSegmentation<pcl::PointXYZ> segmentation;
  segmentation.setInputCloud(cloud);
  segmentation.setForegroundPoints(seeds);
  segmentation.setSigma(kSigma);
  segmentation.setRadius(kRadius);
  segmentation.setNumberOfNeighbours(kNeighbours);
  segmentation.setSourceWeight(0.8);
  std::vector<pcl::PointIndices> clusters;
  segmentation.extract(clusters);
  PclCut result{std::vector<bool>(points.size(), false), segmentation.getMaxFlow()};
  for (const int i : clusters.at(1).indices) result.person[i] = true;
  return result;
}

struct OurCut {
  std::vector<bool> person;
  double cost = 0;  ///< of this labelling, by PCL's weights
};

OurCut cutByUs(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& seed) {
  GraphCut graph;
  const int count = static_cast<int>(points.size());
  graph.begin(count, count * kNeighbours);
  for (const auto& p : points) {
    const float unary = (p - seed).norm() < 1e-6F
                            ? kCertain
                            : paperUnary(p, {seed}, Eigen::Vector3f::UnitZ(), kRadius);
    graph.addNode(std::max(0.0F, unary), std::max(0.0F, -unary));
  }
  // PCL's edges lead from a point to its neighbours only.
  std::set<std::pair<int, int>> edges;
  for (int i = 0; i < count; ++i) {
    std::vector<int> order(count);
    for (int j = 0; j < count; ++j) order[j] = j;
    const auto nearer = [&](int a, int b) {
      return (points[a] - points[i]).squaredNorm() < (points[b] - points[i]).squaredNorm();
    };
    std::partial_sort(order.begin(), order.begin() + kNeighbours, order.end(), nearer);
    for (int k = 1; k < kNeighbours; ++k) {
      edges.insert({i, order[k]});
    }
  }
  for (const auto& [a, b] : edges) {
    graph.addEdge(a, b, smoothnessCost((points[a] - points[b]).norm(), kSigma), 0.0F);
  }
  graph.solve();
  OurCut result{std::vector<bool>(count), 0};
  for (int i = 0; i < count; ++i) {
    result.person[i] = graph.isPerson(i);
    const double penalty = (points[i] - seed).head<2>().norm() / kRadius;
    result.cost += result.person[i] ? penalty : 0.8;
  }
  for (const auto& [a, b] : edges) {
    if (result.person[a] && !result.person[b]) {
      result.cost += smoothnessCost((points[a] - points[b]).norm(), kSigma);
    }
  }
  return result;
}

TEST(MinCut, AgreesWithPcl) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    const auto points = makeCloud(seed);
    const PclCut theirs = cutByPcl(points, points.front());
    const OurCut ours = cutByUs(points, points.front());
    // The cost of our cut is the maximum flow that PCL finds: both are the cheapest cut.
    EXPECT_NEAR(ours.cost, theirs.max_flow, 0.005 * theirs.max_flow) << seed;
    // PCL reports only those points of the person's side whose own link is not used up.
    int people = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      people += theirs.person[i];
      if (theirs.person[i]) {
        EXPECT_TRUE(ours.person[i]) << seed << " " << i;
      }
    }
    EXPECT_GT(people, 50) << seed;
    EXPECT_LT(std::count(ours.person.begin(), ours.person.end(), true), 300) << seed;
  }
}

TEST(MinCut, IsTheCheapestOfAllLabellings) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> weight(0.0F, 3.0F);
  for (int trial = 0; trial < 50; ++trial) {
    constexpr int kNodes = 8;
    GraphCut graph;
    graph.begin(kNodes, kNodes * kNodes);
    float person[kNodes], other[kNodes], edge[kNodes][kNodes];
    for (int i = 0; i < kNodes; ++i) {
      person[i] = weight(random);
      other[i] = weight(random);
      EXPECT_EQ(graph.addNode(person[i], other[i]), i);
    }
    for (int i = 0; i < kNodes; ++i) {
      for (int j = i + 1; j < kNodes; ++j) {
        edge[i][j] = 0.3F * weight(random);
        graph.addEdge(i, j, edge[i][j]);
      }
    }
    graph.solve();
    const auto cost = [&](unsigned labels) {
      float sum = 0;
      for (int i = 0; i < kNodes; ++i) {
        sum += (labels >> i & 1U) != 0 ? other[i] : person[i];
        for (int j = i + 1; j < kNodes; ++j) {
          if ((labels >> i & 1U) != (labels >> j & 1U)) sum += edge[i][j];
        }
      }
      return sum;
    };
    unsigned ours = 0;
    float best = 1e9F;
    for (int i = 0; i < kNodes; ++i) ours |= static_cast<unsigned>(graph.isPerson(i)) << i;
    for (unsigned labels = 0; labels < 1U << kNodes; ++labels) best = std::min(best, cost(labels));
    EXPECT_LE(cost(ours), best + 0.1F) << trial;  // weights are rounded to 1/256
  }
}

TEST(PaperTerms, AreThoseOfThePaper) {
  EXPECT_FLOAT_EQ(smoothnessCost(0.25F, 0.25F), std::exp(-1.0F));
  const Eigen::Vector3f joint(0, 0, 2), up = Eigen::Vector3f::UnitZ();
  // P = horizontal distance / r against the constant 0.8; height does not count.
  EXPECT_NEAR(paperUnary({0.3F, 0.4F, 2}, {joint}, up, 0.2F), 0.8 - 0.5 / 0.2, 1e-5);
  EXPECT_NEAR(paperUnary({0.3F, 0.4F, 9}, {joint}, up, 0.2F), 0.8 - 0.5 / 0.2, 1e-5);
  EXPECT_NEAR(paperUnary({0.3F, 7, 2}, {joint}, Eigen::Vector3f::UnitY(), 0.2F), 0.8 - 1.5, 1e-5);
}

}  // namespace
}  // namespace pf

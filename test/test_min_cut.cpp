// SPDX-License-Identifier: BSD-3-Clause
// The paper's energy cuts an organised cloud as PCL's MinCutSegmentation does.
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/segmentation/min_cut_segmentation.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "posefusion/segmentation/graph_cut.hpp"
#include "posefusion/segmentation/paper_cut.hpp"

namespace pf {
namespace {

/// A rough figure before a wall, seen by a camera of 40 x 30 pixels; some pixels have no depth.
struct Cloud {
  SceneGrid grid;
  std::vector<Eigen::Vector3f> seeds;

  explicit Cloud(unsigned random_seed, int people = 1) {
    std::mt19937 random(random_seed);
    std::normal_distribution<float> noise_m(0.0F, 0.01F);
    std::bernoulli_distribution hole(0.05);
    const PinholeCamera camera{40, 30, 33, 33, 19.5, 14.5, {}};
    RgbdFrame frame{1, cv::Mat(30, 40, CV_8UC3, cv::Scalar(0, 0, 0)), cv::Mat(30, 40, CV_32FC1),
                    1e-3, camera};
    People detected;
    for (int v = 0; v < 30; ++v) {
      for (int u = 0; u < 40; ++u) {
        const bool figure =
            (std::abs(u - 14) < 4 && v > 4) || (people > 1 && std::abs(u - 30) < 3 && v > 8);
        frame.depth.at<float>(v, u) =
            hole(random) ? 0.0F : (figure ? 1.6F : 2.8F) + noise_m(random);
      }
    }
    const auto detect = [&](float u, float v) {
      Person person;
      for (int i = 0; i < 6; ++i) person.joints[i] = {u, v + 3.5F * i, 0.9F};
      detected.people.push_back(person);
    };
    detect(14, 7);
    if (people > 1) detect(30, 11);
    sampleGrid(frame, frame.depth, 40, grid);
    seeds = liftJoints(detected, grid);
  }
};

struct PclCut {
  std::vector<int> person;  ///< cells
  double cost = 0;          ///< of the cheapest cut
};

PclCut cutByPcl(const Cloud& cloud) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr points(new pcl::PointCloud<pcl::PointXYZ>);
  pcl::PointCloud<pcl::PointXYZ>::Ptr seeds(new pcl::PointCloud<pcl::PointXYZ>);
  std::vector<int> cells;
  for (int cell = 0; cell < cloud.grid.size(); ++cell) {
    if (!cloud.grid.hasDepth(cell)) continue;
    cells.push_back(cell);
    const Eigen::Vector3f p = cloud.grid.point(cell);
    points->emplace_back(p.x(), p.y(), p.z());
  }
  for (const Eigen::Vector3f& p : cloud.seeds) seeds->emplace_back(p.x(), p.y(), p.z());
  const PaperTerms terms;
  pcl::MinCutSegmentation<pcl::PointXYZ> segmentation;
  segmentation.setInputCloud(points);
  segmentation.setForegroundPoints(seeds);
  segmentation.setSigma(terms.sigma_m);
  segmentation.setRadius(terms.radius_m);
  segmentation.setNumberOfNeighbours(terms.neighbours);
  segmentation.setSourceWeight(terms.foreground_weight);
  std::vector<pcl::PointIndices> clusters;
  segmentation.extract(clusters);
  PclCut result;
  for (const int i : clusters.at(1).indices) result.person.push_back(cells[i]);
  result.cost = segmentation.getMaxFlow();
  return result;
}

TEST(PaperCut, AgreesWithPcl) {
  for (const int people : {1, 2}) {
    for (const unsigned random_seed : {1U, 2U, 3U}) {
      const Cloud cloud(random_seed, people);
      ASSERT_GE(cloud.seeds.size(), 1U);
      const PclCut theirs = cutByPcl(cloud);
      std::vector<std::uint8_t> labels;
      const double cost = PaperCutter().cut(cloud.grid, cloud.seeds, PaperTerms(), labels);
      // Weights are rounded to 1/256.
      EXPECT_NEAR(cost, theirs.cost, 0.002 * theirs.cost) << random_seed;
      // PCL reports only those points of the person's side whose own link is not used up.
      EXPECT_GT(theirs.person.size(), 10U) << random_seed;
      for (const int cell : theirs.person) EXPECT_EQ(labels[cell], 1) << random_seed << " " << cell;
      const auto ours = std::count(labels.begin(), labels.end(), 1);
      EXPECT_LT(ours, cloud.grid.size() / 2) << random_seed;
    }
  }
}

TEST(PaperCut, NothingWithoutSeeds) {
  const Cloud cloud(1);
  std::vector<std::uint8_t> labels;
  EXPECT_EQ(PaperCutter().cut(cloud.grid, {}, PaperTerms(), labels), 0.0);
  EXPECT_EQ(std::count(labels.begin(), labels.end(), 1), 0);
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
    const double flow = graph.solve();
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
    EXPECT_NEAR(flow, best, 0.1) << trial;
  }
}

TEST(PaperTerms, AreThoseOfThePaper) {
  EXPECT_FLOAT_EQ(smoothnessCost(0.25F, 0.25F), std::exp(-1.0F));
  const Eigen::Vector3f joint(0, 0, 2), up = Eigen::Vector3f::UnitZ();
  // P = horizontal distance / r; height does not count.
  EXPECT_NEAR(backgroundPenalty({0.3F, 0.4F, 2}, {joint}, up, 0.2F), 0.5 / 0.2, 1e-5);
  EXPECT_NEAR(backgroundPenalty({0.3F, 0.4F, 9}, {joint}, up, 0.2F), 0.5 / 0.2, 1e-5);
  EXPECT_NEAR(backgroundPenalty({0.3F, 7, 2}, {joint}, Eigen::Vector3f::UnitY(), 0.2F), 1.5, 1e-5);
}

}  // namespace
}  // namespace pf

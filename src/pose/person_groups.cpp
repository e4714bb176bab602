// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/person_groups.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "vote_groups.hpp"

namespace pf {
namespace {

constexpr float kMinMask = 0.4F;        // probability of a cell that has a vote
constexpr float kMinJoint = 0.2F;       // height of a peak that is a joint
constexpr int kScoredJoints = 6;        // their mean is the person's score
constexpr float kJointReach_m = 0.50F;  // of a joint's vote
constexpr float kMinArea_m2 = 0.015F;   // of a group's cells, as seen: less is no person
// A person cut by the image border shows few joints. The mask then counts as much as joints that
// are less likely by this.
constexpr float kCutArea_m2 = 0.05F;
constexpr float kMaskAboveJoints = 0.2F;

/// Sums of the mask over a group.
struct MaskSums {
  float weight = 0.0F, cells = 0.0F;
  bool at_border = false;  // sensors see nothing in the outermost pixels: the next cell counts too

  void add(const Vote& vote) {
    const int x = vote.cell % kMaskWidth, y = vote.cell / kMaskWidth;
    weight += std::min(vote.weight, 1.0F);
    cells += 1.0F;
    at_border |= std::min(x, y) <= 1 || x >= kMaskWidth - 2 || y >= kMaskHeight - 2;
  }
  float mean() const { return cells > 0.0F ? weight / cells : 0.0F; }
};

float valueAt(const cv::Mat& map, int x, int y) { return map.at<float>(y, x); }

/// Vote of a cell of the maps of joints.
cv::Point2f voteOf(const PersonMaps& maps, int x, int y) {
  return {4.0F * static_cast<float>(x) + 1.5F + kOffsetUnit_px * valueAt(maps.offset_x, x, y),
          4.0F * static_cast<float>(y) + 1.5F + kOffsetUnit_px * valueAt(maps.offset_y, x, y)};
}

/// The nearest depth in a square of the input that has any; 0: none.
float nearestDepth(const cv::Mat& small_m, int x0, int y0, int side) {
  float nearest = 0.0F;
  for (int y = y0; y < y0 + side; ++y) {
    for (int x = x0; x < x0 + side; ++x) {
      const float z = small_m.at<float>(y, x);
      if (z > 0.0F && (nearest == 0.0F || z < nearest)) nearest = z;
    }
  }
  return nearest;
}

std::vector<Vote> collectVotes(const PersonMaps& maps, const cv::Mat& small_m) {
  std::vector<Vote> votes;
  for (int y = 0; y < kMaskHeight; ++y) {
    for (int x = 0; x < kMaskWidth; ++x) {
      const float weight = valueAt(maps.mask, x, y);
      if (!(weight > kMinMask)) continue;
      const float z = nearestDepth(small_m, 2 * x, 2 * y, 2);
      const cv::Point2f at = voteOf(maps, x / 2, y / 2);
      if (z <= 0.0F || !std::isfinite(at.x) || !std::isfinite(at.y)) continue;
      votes.push_back({y * kMaskWidth + x, at.x, at.y, z, weight, -1});
    }
  }
  return votes;
}

/// A cell of a joint's map that is above its neighbours.
bool isJointPeak(const cv::Mat& map, int x, int y) {
  const float value = valueAt(map, x, y);
  if (!(value > kMinJoint)) return false;
  for (int v = std::max(0, y - 1); v <= std::min(map.rows - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(map.cols - 1, x + 1); ++u) {
      const bool earlier = v < y || (v == y && u < x);
      if (valueAt(map, u, v) > value || (earlier && valueAt(map, u, v) == value)) return false;
    }
  }
  return true;
}

/// Centre of gravity of the 3x3 cells around a peak, in pixels of the input.
cv::Point2f jointCentroid(const cv::Mat& map, int x, int y) {
  double sum = 0.0, sum_x = 0.0, sum_y = 0.0;
  for (int v = std::max(0, y - 1); v <= std::min(map.rows - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(map.cols - 1, x + 1); ++u) {
      const double weight = std::max(0.0F, valueAt(map, u, v));
      sum += weight;
      sum_x += weight * u;
      sum_y += weight * v;
    }
  }
  return {static_cast<float>(4.0 * sum_x / sum + 1.5), static_cast<float>(4.0 * sum_y / sum + 1.5)};
}

/// The person whose centre a joint votes for; -1: no person.
int personOf(const InputCamera& camera, const std::vector<Group>& groups, const cv::Point2f& vote,
             float z) {
  int best = -1;
  float nearest = kJointReach_m * kJointReach_m;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i].area_m2 < kMinArea_m2) continue;
    if (z > 0.0F && std::abs(z - groups[i].z) > kBodyDepthReach_m) continue;
    const float distance2 = across2(camera, groups[i], vote.x, vote.y);
    if (!(distance2 < nearest)) continue;
    nearest = distance2;
    best = static_cast<int>(i);
  }
  return best;
}

void addJoints(const PersonMaps& maps, const cv::Mat& small_m, const InputCamera& camera,
               std::vector<Group>& groups) {
  for (std::size_t j = 0; j < maps.joints.size(); ++j) {
    const cv::Mat& map = maps.joints[j];
    for (int y = 0; y < map.rows; ++y) {
      for (int x = 0; x < map.cols; ++x) {
        if (!isJointPeak(map, x, y)) continue;
        const float z = nearestDepth(small_m, 4 * x, 4 * y, 4);
        const int index = personOf(camera, groups, voteOf(maps, x, y), z);
        if (index < 0) continue;
        Keypoint& joint = groups[static_cast<std::size_t>(index)].person.joints[j];
        const float p = std::min(valueAt(map, x, y), 1.0F);
        if (p <= joint.p) continue;
        const cv::Point2f at = camera.grid.toImage(jointCentroid(map, x, y));
        joint = {at.x, at.y, p};
      }
    }
  }
}

/// The mean of the best joints; missing joints count as 0.
float scoreOfJoints(const Person& person) {
  std::array<float, kJointCount> p{};
  for (std::size_t j = 0; j < p.size(); ++j) p[j] = person.joints[j].p;
  std::sort(p.begin(), p.end(), std::greater<>());
  float score = 0.0F;
  for (int j = 0; j < kScoredJoints; ++j) score += p[static_cast<std::size_t>(j)] / kScoredJoints;
  return score;
}

void scorePeople(const std::vector<Vote>& votes, std::vector<Group>& groups) {
  std::vector<MaskSums> sums(groups.size());
  for (const Vote& vote : votes) {
    if (vote.group >= 0) sums[static_cast<std::size_t>(vote.group)].add(vote);
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    float& score = groups[i].person.score;
    score = scoreOfJoints(groups[i].person);
    const bool is_cut = sums[i].at_border && groups[i].area_m2 >= kCutArea_m2;
    if (is_cut && score > 0.0F) score = std::max(score, sums[i].mean() - kMaskAboveJoints);
  }
}

/// Group of each person, best first.
std::vector<int> bestFirst(const std::vector<Group>& groups, int max_people) {
  std::vector<int> order;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i].area_m2 >= kMinArea_m2 && groups[i].person.score > 0.0F) {
      order.push_back(static_cast<int>(i));
    }
  }
  const auto evidence = [&](int i) {
    const Group& group = groups[static_cast<std::size_t>(i)];
    return group.person.score * group.area_m2;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return evidence(a) > evidence(b); });
  if (static_cast<int>(order.size()) > max_people) {
    order.resize(static_cast<std::size_t>(max_people));
  }
  return order;
}

PersonMask maskOf(const PersonMaps& maps, const std::vector<Vote>& votes,
                  const std::vector<int>& order) {
  PersonMask mask;
  mask.probability.create(kMaskHeight, kMaskWidth, CV_8UC1);
  mask.owner = cv::Mat::zeros(kMaskHeight, kMaskWidth, CV_8UC1);
  for (int y = 0; y < kMaskHeight; ++y) {
    for (int x = 0; x < kMaskWidth; ++x) {
      const float p = valueAt(maps.mask, x, y);
      const auto step = p > 0.0F ? std::lround(255.0F * std::min(p, 1.0F)) : 0L;
      mask.probability.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(step);
    }
  }
  for (const Vote& vote : votes) {
    const auto person = std::find(order.begin(), order.end(), vote.group);
    const int owner = person == order.end() ? 0 : 1 + static_cast<int>(person - order.begin());
    mask.owner.ptr<std::uint8_t>()[vote.cell] = static_cast<std::uint8_t>(owner);
  }
  return mask;
}

}  // namespace

People groupPeople(const PersonMaps& maps, const cv::Mat& small_m, const PinholeCamera& camera,
                   int max_people) {
  const InputCamera input(camera);
  std::vector<Vote> votes = collectVotes(maps, small_m);
  std::vector<Group> groups = groupVotes(input, votes);
  addJoints(maps, small_m, input, groups);
  scorePeople(votes, groups);
  const std::vector<int> order = bestFirst(groups, max_people);
  People people;
  people.detected = true;
  for (const int i : order) people.people.push_back(groups[static_cast<std::size_t>(i)].person);
  people.mask = maskOf(maps, votes, order);
  return people;
}

}  // namespace pf

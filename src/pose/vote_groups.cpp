// SPDX-License-Identifier: BSD-3-Clause
#include "vote_groups.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "posefusion/pose/person_model.hpp"

namespace pf {
namespace {

constexpr float kReach_m = 0.40F;       // of votes around their centre, across the view
constexpr float kSamePerson_m = 0.35F;  // two groups nearer than this are one person
constexpr int kMaxGroups = 40;          // looked at
constexpr int kShifts = 4;              // of a centre to the mean of its votes
constexpr int kMargin = 20;             // bins around the view: centres may lie outside of it

/// Finds groups of votes, the densest first.
class Grouper {
 public:
  Grouper(const InputCamera& camera, std::vector<Vote>& votes) : camera_(camera), votes_(votes) {}

  std::vector<Group> find() {
    std::vector<Group> groups;
    for (int i = 0; i < kMaxGroups && !votes_.empty(); ++i) {
      Group group;
      if (!start(group, i)) break;
      for (int shift = 0; shift < kShifts; ++shift) moveToMean(group);
      assign(group, i);
      groups.push_back(group);
    }
    join(groups);
    return groups;
  }

 private:
  bool isNear(const Group& group, const Vote& vote) const {
    return std::abs(vote.z - group.z) < kBodyDepthReach_m &&
           across2(camera_, group, vote.x, vote.y) < kReach_m * kReach_m;
  }

  static int binOf(float pixel, int bins) {
    const float bin = std::floor(pixel / 4.0F) + static_cast<float>(kMargin);
    return static_cast<int>(std::clamp(bin, 0.0F, static_cast<float>(bins - 1)));
  }

  /// The free vote that has most free votes around it in the image.
  bool start(Group& group, int index) {
    cv::Mat density(kMapHeight + 2 * kMargin, kMapWidth + 2 * kMargin, CV_32FC1, cv::Scalar(0));
    for (const Vote& vote : votes_) {
      if (vote.group >= 0) continue;
      density.at<float>(binOf(vote.y, density.rows), binOf(vote.x, density.cols)) += vote.weight;
    }
    Vote* best = nullptr;
    float most = 0.0F;
    for (Vote& vote : votes_) {
      if (vote.group >= 0) continue;
      const float here = around(density, binOf(vote.x, density.cols), binOf(vote.y, density.rows));
      if (here <= most) continue;
      most = here;
      best = &vote;
    }
    if (best == nullptr) return false;
    group = Group{best->x, best->y, best->z, 0.0F, 0.0F, {}};
    take(*best, index, group);  // wherever the mean goes: each round takes one vote at least
    return true;
  }

  static float around(const cv::Mat& density, int x, int y) {
    float sum = 0.0F;
    for (int v = std::max(0, y - 1); v <= std::min(density.rows - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(density.cols - 1, x + 1); ++u) {
        sum += density.at<float>(v, u);
      }
    }
    return sum;
  }

  void moveToMean(Group& group) const {
    double sum = 0.0, x = 0.0, y = 0.0, z = 0.0;
    for (const Vote& vote : votes_) {
      if (vote.group >= 0 || !isNear(group, vote)) continue;
      const double weight = vote.weight;
      sum += weight;
      x += weight * vote.x;
      y += weight * vote.y;
      z += weight * vote.z;
    }
    if (sum <= 0.0) return;
    group.x = static_cast<float>(x / sum);
    group.y = static_cast<float>(y / sum);
    group.z = static_cast<float>(z / sum);
  }

  void assign(Group& group, int index) {
    for (Vote& vote : votes_) {
      if (vote.group < 0 && isNear(group, vote)) take(vote, index, group);
    }
  }

  void take(Vote& vote, int index, Group& group) const {
    vote.group = index;
    group.weight += vote.weight;
    group.area_m2 += 2.0F * vote.z / camera_.fx * 2.0F * vote.z / camera_.fy;
  }

  /// A small group beside a larger one is a part of the same body.
  void join(std::vector<Group>& groups) {
    std::vector<int> into(groups.size());
    for (std::size_t i = 0; i < groups.size(); ++i) {
      into[i] = static_cast<int>(i);
      for (std::size_t k = 0; k < i; ++k) {
        if (into[k] != static_cast<int>(k)) continue;
        const bool same =
            std::abs(groups[i].z - groups[k].z) < kBodyDepthReach_m &&
            across2(camera_, groups[k], groups[i].x, groups[i].y) < kSamePerson_m * kSamePerson_m;
        if (!same) continue;
        into[i] = static_cast<int>(k);
        groups[k].weight += groups[i].weight;
        groups[k].area_m2 += groups[i].area_m2;
        groups[i].area_m2 = 0.0F;
        break;
      }
    }
    for (Vote& vote : votes_) {
      if (vote.group >= 0) vote.group = into[static_cast<std::size_t>(vote.group)];
    }
  }

  const InputCamera& camera_;
  std::vector<Vote>& votes_;
};

}  // namespace

float across2(const InputCamera& camera, const Group& group, float x, float y) {
  const float dx = (x - group.x) / camera.fx * group.z;
  const float dy = (y - group.y) / camera.fy * group.z;
  return dx * dx + dy * dy;
}

std::vector<Group> groupVotes(const InputCamera& camera, std::vector<Vote>& votes) {
  return Grouper(camera, votes).find();
}

}  // namespace pf

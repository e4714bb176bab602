// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/assembly.hpp"

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr float kMinAgreement = 0.05F;     // of the field with the limb's direction, per sample
constexpr float kMinAgreeingPart = 0.95F;  // of the samples

/// Bilinear value, the border repeated.
float sample(const cv::Mat& map, float x, float y) {
  x = std::clamp(x, 0.0F, static_cast<float>(map.cols - 1));
  y = std::clamp(y, 0.0F, static_cast<float>(map.rows - 1));
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, map.cols - 1);
  const int y1 = std::min(y0 + 1, map.rows - 1);
  const float a = x - static_cast<float>(x0);
  const float b = y - static_cast<float>(y0);
  const float* upper = map.ptr<float>(y0);
  const float* lower = map.ptr<float>(y1);
  return (1 - b) * ((1 - a) * upper[x0] + a * upper[x1]) +
         b * ((1 - a) * lower[x0] + a * lower[x1]);
}

struct Link {
  int from = 0;  ///< index of the peak of the limb's first part
  int to = 0;
  float score = 0.0F;
};

/// The best set of links of one limb in which no peak occurs twice, greedily.
std::vector<Link> matchLimb(const PoseMaps& maps, const NetworkLimb& limb,
                            const std::vector<std::vector<Peak>>& peaks) {
  const cv::Mat field_x = maps.plane(limb.channel_x);
  const cv::Mat field_y = maps.plane(limb.channel_y);
  std::vector<Link> candidates;
  const auto& starts = peaks[limb.from];
  const auto& ends = peaks[limb.to];
  for (std::size_t i = 0; i < starts.size(); ++i) {
    for (std::size_t j = 0; j < ends.size(); ++j) {
      const float score = limbScore(field_x, field_y, starts[i], ends[j]);
      if (score > 0) candidates.push_back({static_cast<int>(i), static_cast<int>(j), score});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Link& a, const Link& b) { return a.score > b.score; });
  std::vector<char> start_used(starts.size(), 0), end_used(ends.size(), 0);
  std::vector<Link> links;
  for (const Link& link : candidates) {
    if (start_used[link.from] || end_used[link.to]) continue;
    start_used[link.from] = end_used[link.to] = 1;
    links.push_back(link);
  }
  return links;
}

/// A person while it grows: the peak of each part (-1: none) and the sum of peak and link scores.
struct Draft {
  std::vector<int> peak_of_part;
  float score_sum = 0.0F;
  int parts = 0;
};

class Assembler {
 public:
  explicit Assembler(const std::vector<std::vector<Peak>>& peaks) : peaks_(peaks) {}

  void add(const NetworkLimb& limb, const Link& link) {
    Draft* first = holder(limb.from, link.from);
    Draft* second = holder(limb.to, link.to);
    if (first == nullptr && second == nullptr) {
      drafts_.push_back({std::vector<int>(peaks_.size(), -1), 0.0F, 0});
      first = &drafts_.back();
      put(*first, limb.from, link.from);
    }
    if (first != nullptr && second == nullptr) {
      extend(*first, limb.to, link.to, link.score);
    } else if (first == nullptr) {
      extend(*second, limb.from, link.from, link.score);
    } else if (first == second) {
      first->score_sum += link.score;
    } else {
      merge(*first, *second, link.score);
    }
  }

  const std::vector<Draft>& drafts() const { return drafts_; }

 private:
  Draft* holder(int part, int peak) {
    for (Draft& draft : drafts_) {
      if (draft.parts > 0 && draft.peak_of_part[part] == peak) return &draft;
    }
    return nullptr;
  }

  void put(Draft& draft, int part, int peak) {
    draft.peak_of_part[part] = peak;
    draft.score_sum += peaks_[part][peak].p;
    ++draft.parts;
  }

  void extend(Draft& draft, int part, int peak, float link_score) {
    if (draft.peak_of_part[part] >= 0) return;  // the person has such a part already
    put(draft, part, peak);
    draft.score_sum += link_score;
  }

  /// Two halves of one person meet, unless they have a part in common.
  static void merge(Draft& into, Draft& from, float link_score) {
    for (std::size_t part = 0; part < into.peak_of_part.size(); ++part) {
      if (into.peak_of_part[part] >= 0 && from.peak_of_part[part] >= 0) return;
    }
    for (std::size_t part = 0; part < into.peak_of_part.size(); ++part) {
      if (from.peak_of_part[part] >= 0) into.peak_of_part[part] = from.peak_of_part[part];
    }
    into.score_sum += from.score_sum + link_score;
    into.parts += from.parts;
    from = Draft{std::vector<int>(into.peak_of_part.size(), -1), 0.0F, 0};
  }

  const std::vector<std::vector<Peak>>& peaks_;
  std::vector<Draft> drafts_;
};

Person toPerson(const Draft& draft, const ModelSettings& settings,
                const std::vector<std::vector<Peak>>& peaks, const cv::Point2f& scale) {
  Person person;
  person.score = draft.score_sum / static_cast<float>(draft.parts);
  for (std::size_t part = 0; part < settings.parts.size(); ++part) {
    if (settings.parts[part].joint < 0 || draft.peak_of_part[part] < 0) continue;
    const Peak& peak = peaks[part][draft.peak_of_part[part]];
    person.joints[settings.parts[part].joint] = {
        (peak.x + 0.5F) * scale.x - 0.5F, (peak.y + 0.5F) * scale.y - 0.5F, std::min(peak.p, 1.0F)};
  }
  return person;
}

int jointsOf(const Person& person) {
  return static_cast<int>(std::count_if(person.joints.begin(), person.joints.end(),
                                        [](const Keypoint& k) { return k.p > 0; }));
}

}  // namespace

float limbScore(const cv::Mat& field_x, const cv::Mat& field_y, const Peak& from, const Peak& to) {
  const float dx = to.x - from.x;
  const float dy = to.y - from.y;
  const float length = std::hypot(dx, dy);
  if (length < 1e-3F) return 0.0F;
  const float longest = std::max(std::abs(dx), std::abs(dy));
  // OpenPose counts the longest side in input pixels at stride 8.
  const int samples =
      std::clamp(static_cast<int>(std::lround(std::sqrt(5.0F * 8.0F * longest))), 5, 25);
  float sum = 0.0F;
  int agreeing = 0;
  for (int i = 0; i < samples; ++i) {
    const float t = static_cast<float>(i) / static_cast<float>(samples - 1);
    const float x = from.x + t * dx;
    const float y = from.y + t * dy;
    const float dot = (sample(field_x, x, y) * dx + sample(field_y, x, y) * dy) / length;
    if (dot > kMinAgreement) {
      sum += dot;
      ++agreeing;
    }
  }
  if (static_cast<float>(agreeing) < kMinAgreeingPart * static_cast<float>(samples)) return 0.0F;
  return sum / static_cast<float>(agreeing);
}

std::vector<Person> assemblePeople(const PoseMaps& maps, const ModelSettings& settings,
                                   const std::vector<std::vector<Peak>>& peaks,
                                   const cv::Size& image, const PoseConfig& config) {
  Assembler assembler(peaks);
  for (const NetworkLimb& limb : settings.limbs) {
    for (const Link& link : matchLimb(maps, limb, peaks)) assembler.add(limb, link);
  }
  const cv::Point2f scale(
      static_cast<float>(image.width) / static_cast<float>(maps.size().width),
      static_cast<float>(image.height) / static_cast<float>(maps.size().height));
  std::vector<Person> people;
  for (const Draft& draft : assembler.drafts()) {
    if (draft.parts == 0) continue;
    const Person person = toPerson(draft, settings, peaks, scale);
    if (jointsOf(person) >= config.min_person_joints && person.score >= config.min_person_score) {
      people.push_back(person);
    }
  }
  std::stable_sort(people.begin(), people.end(),
                   [](const Person& a, const Person& b) { return a.score > b.score; });
  if (static_cast<int>(people.size()) > config.max_people) people.resize(config.max_people);
  return people;
}

}  // namespace pf

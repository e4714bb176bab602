// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/mapped_people.hpp"

#include <algorithm>

namespace pf {
namespace {

constexpr int kSureJoints = 5;
constexpr float kSureScore = 0.55F;  // of the detection

}  // namespace

bool isMappedPerson(const Evidence& evidence, const std::vector<TrackedPerson>& people, int cell) {
  const int shown = evidence.shown_person[cell];
  if (shown < 0 || !isShown(evidence.shown, cell) || isFlat(evidence, cell)) return false;
  const Background background = evidence.background[cell];
  return (background == Background::agrees || background == Background::recent) &&
         people[shown].fresh && isSure(people[shown].person);
}

bool isSure(const Person& person) {
  const auto joints = std::count_if(person.joints.begin(), person.joints.end(),
                                    [](const Keypoint& k) { return k.p > 0.0F; });
  return joints >= kSureJoints && person.score >= kSureScore;
}

}  // namespace pf

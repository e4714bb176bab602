// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/mapped_people.hpp"

#include <algorithm>

namespace pf {
namespace {

constexpr int kSureJoints = 5;
constexpr float kSureScore = 0.55F;   // of the detection
constexpr float kMappedReach = 1.5F;  // capsule radii within which a surface is the person's

bool isMapped(const Evidence& evidence, const std::vector<TrackedPerson>& people, int owner,
              int cell) {
  const TrackedPerson& tracked = people[owner];
  if (isMappedPerson(evidence, people, cell)) return true;
  if (isFlat(evidence, cell) || evidence.distance.relative[cell] > kMappedReach) return false;
  const Background background = evidence.background[cell];
  if (background == Background::agrees) return tracked.in_map;
  return background == Background::recent &&
         (tracked.in_map || (tracked.fresh && isSure(tracked.person)));
}

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

std::vector<std::uint8_t> findMappedPeople(const Evidence& evidence,
                                           const std::vector<TrackedPerson>& people,
                                           const std::vector<std::uint8_t>& labels) {
  std::vector<std::uint8_t> mapped(labels.size(), 0);
  for (int cell = 0; cell < evidence.grid.size(); ++cell) {
    const int owner = candidateOf(evidence, cell);
    mapped[cell] = labels[cell] != 0 && owner >= 0 && isMapped(evidence, people, owner, cell);
  }
  return mapped;
}

}  // namespace pf

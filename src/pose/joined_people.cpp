// SPDX-License-Identifier: BSD-3-Clause
#include "joined_people.hpp"

#include <algorithm>

#include "posefusion/pose/person_mask.hpp"

namespace pf {
namespace {

constexpr int kMinShare = 3;  // a person needs 1/3 of its joints on one person of the mask

/// The person of the mask that holds most joints; -1: no person.
int shownPerson(const Person& person, const People& embedded, const MaskGrid& grid) {
  std::vector<int> joints(embedded.people.size() + 1, 0);
  int seen = 0;
  for (const Keypoint& joint : person.joints) {
    const int cell = joint.p > 0.0F ? grid.cellAt(joint.u, joint.v) : -1;
    if (cell < 0) continue;
    ++seen;
    ++joints[embedded.mask.owner.ptr<std::uint8_t>()[cell]];
  }
  const auto most = std::max_element(joints.begin() + 1, joints.end());
  if (most == joints.end() || *most == 0 || kMinShare * *most < seen) return -1;
  return static_cast<int>(most - joints.begin()) - 1;
}

}  // namespace

People joinPeople(const People& network, People embedded, const cv::Size& image, int max_people) {
  const MaskGrid grid(image);
  const std::size_t shown = embedded.people.size();
  std::vector<bool> joined(shown, false);
  for (const Person& person : network.people) {
    const int index = shown > 0 ? shownPerson(person, embedded, grid) : -1;
    if (index < 0 || joined[static_cast<std::size_t>(index)]) {
      embedded.people.push_back(person);
      continue;
    }
    joined[static_cast<std::size_t>(index)] = true;
    Person& same = embedded.people[static_cast<std::size_t>(index)];
    same.score += (1.0F - same.score) * person.score;  // two say so that see different things
    for (std::size_t j = 0; j < same.joints.size(); ++j) {
      if (person.joints[j].p > 0.0F) same.joints[j] = person.joints[j];
    }
  }
  if (static_cast<int>(embedded.people.size()) > max_people) {
    embedded.people.resize(std::max(shown, static_cast<std::size_t>(max_people)));
  }
  return embedded;
}

}  // namespace pf

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "posefusion/io/people_json.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

People peopleAt(std::int64_t stamp_ns, std::size_t count) {
  std::mt19937 random(static_cast<unsigned>(stamp_ns));
  std::uniform_real_distribution<float> unit(0, 1);
  People people{stamp_ns, true, std::vector<Person>(count)};
  for (auto& person : people.people) {
    person.score = unit(random);
    person.id = static_cast<int>(3 * unit(random));
    for (auto& joint : person.joints)
      joint = {640 * unit(random), 480 * unit(random), unit(random)};
  }
  return people;
}

TEST(PeopleJson, ReadsBackAsTheSameToTheBit) {
  TemporaryFolder folder;
  People unseen;
  unseen.stamp_ns = 5;
  savePeople(folder / "p.json", {peopleAt(1, 2), peopleAt(1033333333, 0), unseen});
  const RecordedPeople read = loadPeople(folder / "p.json");
  ASSERT_EQ(read.size(), 2U) << "a frame that the detector did not look at is not listed";
  EXPECT_TRUE(read.at(1033333333).detected);
  EXPECT_TRUE(read.at(1033333333).people.empty());
  const auto expected = peopleAt(1, 2).people;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.at(1).people[i].score, expected[i].score);
    EXPECT_EQ(read.at(1).people[i].id, expected[i].id);
    for (std::size_t j = 0; j < kJointCount; ++j) {
      EXPECT_EQ(read.at(1).people[i].joints[j].u, expected[i].joints[j].u);
      EXPECT_EQ(read.at(1).people[i].joints[j].p, expected[i].joints[j].p);
    }
  }
}

TEST(PeopleJson, ErrorsNameFileAndFrame) {
  TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    const auto path = folder.write("p.json", text);
    return errorOf([&] { loadPeople(path); });
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(error("{\"frames\": ["), "p.json: is no JSON"));
  EXPECT_TRUE(has(error("{}"), "frames"));
  EXPECT_TRUE(has(error("{\"joints\": [\"nose\"], \"frames\": []}"), "are not those of COCO-18"));
  EXPECT_TRUE(has(error("{\"frames\": [{\"stamp\": \"1\", \"people\": []}, {\"people\": []}]}"),
                  "p.json: frame 1: "));
  EXPECT_TRUE(
      has(error("{\"frames\": [{\"stamp\": \"1\", \"people\": [{\"joints\": [[1,2,3]]}]}]}"),
          "a person has 1 joints, expected 18"));
}

}  // namespace
}  // namespace pf

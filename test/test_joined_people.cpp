// SPDX-License-Identifier: BSD-3-Clause
#include "../src/pose/joined_people.hpp"

#include <gtest/gtest.h>

namespace pf {
namespace {

const cv::Size kImage(640, 480);

Person personAt(float u, int first_joint, int joints, float p) {
  Person person;
  for (int j = first_joint; j < first_joint + joints; ++j) {
    person.joints[j] = {u, 100.0F + 10.0F * static_cast<float>(j), p};
  }
  person.score = p;
  return person;
}

/// Two people seen by the embedded model, in the left and in the right half of the image.
People twoHalves() {
  People people{5, true, {personAt(100, 0, 6, 0.5F), personAt(500, 0, 6, 0.5F)}};
  people.mask.probability = cv::Mat(60, 80, CV_8UC1, cv::Scalar(255));
  people.mask.owner = cv::Mat(60, 80, CV_8UC1, cv::Scalar(1));
  people.mask.owner.colRange(40, 80).setTo(2);
  return people;
}

TEST(JoinedPeople, APersonThatBothSawIsOne) {
  const People network{5, true, {personAt(480, 4, 6, 0.9F)}};
  const People joined = joinPeople(network, twoHalves(), kImage, 15);
  ASSERT_EQ(joined.people.size(), 2U);
  EXPECT_EQ(joined.people[0].joints[4].p, 0.5F) << "the other stays";
  const Person& both = joined.people[1];
  EXPECT_EQ(both.joints[4].u, 480.0F) << "the network's joint";
  EXPECT_EQ(both.joints[9].u, 480.0F);
  EXPECT_EQ(both.joints[0].u, 500.0F) << "the embedded model's, where the network has none";
  EXPECT_FLOAT_EQ(both.score, 0.95F) << "two agree";
  EXPECT_FALSE(joined.mask.empty());
}

TEST(JoinedPeople, APersonThatOnlyOneSawIsKept) {
  People embedded = twoHalves();
  embedded.mask.owner.colRange(20, 40).setTo(0);
  const People network{5, true, {personAt(250, 0, 6, 0.9F)}};
  const People joined = joinPeople(network, embedded, kImage, 15);
  ASSERT_EQ(joined.people.size(), 3U);
  EXPECT_EQ(joined.people[2].joints[0].u, 250.0F) << "after those of the mask";
}

TEST(JoinedPeople, TwoOfTheNetworkInOneMaskStayTwo) {
  const People network{5, true, {personAt(80, 0, 6, 0.9F), personAt(120, 0, 6, 0.8F)}};
  EXPECT_EQ(joinPeople(network, twoHalves(), kImage, 15).people.size(), 3U);
  EXPECT_EQ(joinPeople(network, twoHalves(), kImage, 2).people.size(), 2U);
}

TEST(JoinedPeople, WithoutTheNetworkTheEmbeddedModelSpeaks) {
  const People joined = joinPeople({5, false, {}}, twoHalves(), kImage, 15);
  EXPECT_TRUE(joined.detected);
  EXPECT_EQ(joined.people.size(), 2U);
}

TEST(JoinedPeople, AnEmptyMaskAddsNoPerson) {
  People embedded{5, true, {}};
  embedded.mask = {cv::Mat::zeros(60, 80, CV_8UC1), cv::Mat::zeros(60, 80, CV_8UC1)};
  EXPECT_TRUE(joinPeople({5, true, {}}, embedded, kImage, 15).people.empty());
  const People network{5, true, {personAt(80, 0, 6, 0.9F)}};
  EXPECT_EQ(joinPeople(network, embedded, kImage, 15).people.size(), 1U);
}

}  // namespace
}  // namespace pf

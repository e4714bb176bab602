// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/pose/person_groups.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace pf {
namespace {

const PinholeCamera kCamera{640, 480, 525, 525, 319.5, 239.5, {}};

/// A body as the model would draw it: a box of the input with votes for its middle and joints.
struct Body {
  cv::Rect box;  // pixels of the input
  float depth_m;
  int joints;
};

/// The maps that a perfect model gives of bodies before a wall; the later ones hide the earlier.
struct Drawn {
  cv::Mat small_m{kDepthInputHeight, kDepthInputWidth, CV_32FC1, cv::Scalar(5.0)};
  PersonMaps maps;

  explicit Drawn(const std::vector<Body>& bodies) {
    maps.mask = cv::Mat::zeros(kMaskHeight, kMaskWidth, CV_32FC1);
    for (cv::Mat& map : maps.joints) map = cv::Mat::zeros(kMapHeight, kMapWidth, CV_32FC1);
    for (cv::Mat* map : {&maps.centre, &maps.offset_x, &maps.offset_y}) {
      *map = cv::Mat::zeros(kMapHeight, kMapWidth, CV_32FC1);
    }
    for (const Body& body : bodies) draw(body);
  }

  void draw(const Body& body) {
    small_m(body.box).setTo(body.depth_m);
    maps.mask(half(body.box, 2)).setTo(0.95F);
    const cv::Rect cells = half(body.box, 4);
    const float x = body.box.x + 0.5F * body.box.width, y = body.box.y + 0.5F * body.box.height;
    for (int v = cells.y; v < cells.br().y; ++v) {
      for (int u = cells.x; u < cells.br().x; ++u) {
        maps.offset_x.at<float>(v, u) = (x - (4.0F * u + 1.5F)) / kOffsetUnit_px;
        maps.offset_y.at<float>(v, u) = (y - (4.0F * v + 1.5F)) / kOffsetUnit_px;
      }
    }
    for (int j = 0; j < body.joints; ++j) {
      maps.joints[j].at<float>(cells.y + j % cells.height, cells.br().x - 2) = 0.8F;
    }
  }

  static cv::Rect half(const cv::Rect& r, int by) {
    return {r.x / by, r.y / by, r.width / by, r.height / by};
  }
  People group() const { return groupPeople(maps, small_m, kCamera, 15); }
};

int ownerAt(const People& people, int x, int y) {
  return people.mask.owner.at<uchar>(y / 2, x / 2);
}

TEST(PersonGroups, AnEmptyImageHasNoPeople) {
  const People people = Drawn({}).group();
  EXPECT_TRUE(people.detected);
  EXPECT_TRUE(people.people.empty());
  EXPECT_EQ(cv::countNonZero(people.mask.owner), 0);
}

TEST(PersonGroups, KeepsTwoPeopleApartSideBySideOrOneBehindTheOther) {
  const Body left{{20, 20, 28, 80}, 2.0F, 6}, right{{60, 20, 28, 80}, 2.0F, 6};
  const Body behind{{36, 20, 28, 80}, 3.5F, 6};
  for (const auto& bodies : {std::vector<Body>{left, right}, std::vector<Body>{behind, left}}) {
    const People people = Drawn(bodies).group();
    ASSERT_EQ(people.people.size(), 2U);
    EXPECT_NE(ownerAt(people, 24, 60), 0);
    const cv::Rect& other = bodies[0].box == left.box ? bodies[1].box : bodies[0].box;
    EXPECT_NE(ownerAt(people, other.br().x - 4, 60), 0);
    EXPECT_NE(ownerAt(people, 24, 60), ownerAt(people, other.br().x - 4, 60));
    EXPECT_EQ(ownerAt(people, 140, 60), 0);
  }
}

TEST(PersonGroups, JointsAreWhereTheirPeaksAreAndBelongToTheirBody) {
  const People people = Drawn({{{20, 20, 28, 80}, 2.0F, 5}, {{100, 20, 28, 80}, 2.0F, 5}}).group();
  ASSERT_EQ(people.people.size(), 2U);
  for (const Person& person : people.people) {
    const float u = person.joints[0].u;
    for (int j = 0; j < 5; ++j) {
      EXPECT_NEAR(person.joints[j].p, 0.8, 1e-5);
      EXPECT_NEAR(person.joints[j].u, u, 1e-3);
      // Cell (10 or 30, 5 + j) of 16x16 pixels of the image.
      EXPECT_NEAR(person.joints[j].v, 16 * (5 + j) + 7.5, 1e-3);
    }
    EXPECT_TRUE(std::abs(u - 167.5F) < 1e-3F || std::abs(u - 487.5F) < 1e-3F) << u;
    EXPECT_EQ(person.joints[5].p, 0.0F);
    EXPECT_NEAR(person.score, 0.8 * 5 / 6, 1e-5) << "one of six is missing";
  }
}

TEST(PersonGroups, AMaskWithoutJointsIsAChair) {
  const People people = Drawn({{{20, 20, 28, 80}, 2.0F, 0}}).group();
  EXPECT_TRUE(people.people.empty());
  EXPECT_EQ(cv::countNonZero(people.mask.owner), 0);
  EXPECT_GT(cv::countNonZero(people.mask.probability), 0) << "a known person may be there";
}

TEST(PersonGroups, FewJointsAreAGuess) {
  for (const int joints : {1, 2}) {
    const People people = Drawn({{{20, 20, 28, 80}, 2.0F, joints}}).group();
    ASSERT_EQ(people.people.size(), 1U);
    EXPECT_NEAR(people.people[0].score, 0.8 * joints / 6, 1e-5);
  }
}

TEST(PersonGroups, TheMaskCountsWhereTheBorderCutsAPerson) {
  const cv::Rect inside(20, 20, 28, 80), cut(0, 20, 28, 80), small(0, 20, 8, 20);
  EXPECT_NEAR(Drawn({{inside, 2.0F, 1}}).group().people.at(0).score, 0.8 / 6, 1e-5);
  EXPECT_NEAR(Drawn({{cut, 2.0F, 1}}).group().people.at(0).score, 0.95 - 0.2, 1e-5);
  EXPECT_NEAR(Drawn({{small, 2.0F, 1}}).group().people.at(0).score, 0.8 / 6, 1e-5) << "a hand";
  EXPECT_NEAR(Drawn({{cut, 2.0F, 6}}).group().people.at(0).score, 0.8, 1e-5) << "joints are more";
  EXPECT_TRUE(Drawn({{cut, 2.0F, 0}}).group().people.empty()) << "still a chair";
}

TEST(PersonGroups, KeepsTheBestWhereThereAreTooMany) {
  const Drawn drawn(
      {{{10, 20, 28, 80}, 2.0F, 6}, {{60, 20, 20, 40}, 2.0F, 6}, {{110, 20, 28, 90}, 2.0F, 6}});
  const People people = groupPeople(drawn.maps, drawn.small_m, kCamera, 2);
  ASSERT_EQ(people.people.size(), 2U);
  EXPECT_EQ(ownerAt(people, 70, 30), 0) << "the smallest goes";
}

TEST(PersonGroups, SurvivesNonsense) {
  for (const float value : {std::numeric_limits<float>::quiet_NaN(), 1.0F, 1e30F, -1.0F}) {
    Drawn drawn({});
    drawn.maps.mask.setTo(value);
    for (cv::Mat& map : drawn.maps.joints) map.setTo(value);
    drawn.maps.offset_x.setTo(value);
    drawn.maps.offset_y.setTo(-value);
    EXPECT_LE(drawn.group().people.size(), 15U);
    drawn.small_m.setTo(0.0F);
    EXPECT_TRUE(drawn.group().people.empty()) << "without depth there is no person";
  }
}

}  // namespace
}  // namespace pf

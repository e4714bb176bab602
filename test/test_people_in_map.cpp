// SPDX-License-Identifier: BSD-3-Clause
#include "posefusion/segmentation/people_in_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace pf {
namespace {

constexpr float kPerson_m = 2.0F, kWall_m = 4.0F;
constexpr std::int64_t kFrame_ns = 33'333'333;
const PinholeCamera kCamera{640, 480, 525, 525, 319.5, 239.5, {}};

/// A person, 80 pixels wide and 320 high, before a wall; the joints in two columns.
struct Scene {
  SceneGrid grid;
  TrackedPerson tracked;

  explicit Scene(int left_px) {
    RgbdFrame frame;
    frame.camera = kCamera;
    frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(100));
    cv::Mat depth_m(480, 640, CV_32FC1, cv::Scalar(kWall_m));
    const cv::Rect person(left_px, 80, 80, 320);
    depth_m(person).setTo(kPerson_m);
    sampleGrid(frame, depth_m, 160, grid);
    for (int cell = 0; cell < grid.size(); ++cell) {
      if (grid.z[cell] < 3.0F) tracked.cells.push_back(cell);
    }
    tracked.id = 3;
    for (int j = 0; j < kJointCount; ++j) {
      const int column = j % 2, row = j / 2;
      tracked.person.joints[j] = {static_cast<float>(left_px + 20 + 40 * column),
                                  static_cast<float>(100 + 30 * row), 0.9F};
    }
  }
};

TEST(PeopleInMap, JointsLieOnThePersonThoughTheyAreFoundBesideALimb) {
  Scene scene(200);
  scene.tracked.person.joints[4].u = 283;             // a cell past the edge: the wall
  scene.tracked.person.joints[5] = {400, 200, 0.9F};  // on the wall, far from the mask
  scene.tracked.person.joints[6].p = 0;               // not seen
  const SkeletonPoints points = liftSkeleton(scene.tracked.person, scene.tracked.cells, scene.grid);
  for (int j = 0; j < kJointCount; ++j) {
    if (j == 5 || j == 6) {
      EXPECT_TRUE(std::isnan(points[j].x())) << j;
      continue;
    }
    const Keypoint& joint = scene.tracked.person.joints[j];
    const Eigen::Vector3d expected = kCamera.unproject(joint.u, joint.v, kPerson_m);
    EXPECT_NEAR((points[j].cast<double>() - expected).norm(), 0, 0.02) << j;
  }
}

TEST(PeopleInMap, VelocityIsThatInTheMapHoweverTheCameraMoves) {
  for (const double camera_m_s : {0.0, 0.7}) {
    for (const double person_m_s : {0.0, 0.8}) {
      PeopleInMap people;
      std::vector<MovingObject> found;
      for (int i = 0; i < 30; ++i) {
        const double t_s = i / 30.0;
        Eigen::Isometry3d T_map_camera(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
        T_map_camera.translation() =
            T_map_camera.linear() * Eigen::Vector3d(camera_m_s * t_s, 0, 0);
        const double offset_px = (person_m_s - camera_m_s) * t_s * kCamera.fx / kPerson_m;
        const Scene scene(static_cast<int>(std::lround(280 + offset_px)));
        found = people.place({scene.tracked}, scene.grid, T_map_camera, (i + 1) * kFrame_ns);
      }
      ASSERT_EQ(found.size(), 1U);
      EXPECT_EQ(found[0].id, 3);
      EXPECT_TRUE(found[0].is_person);
      EXPECT_NEAR(found[0].velocity_m_s.x(), person_m_s, 0.08) << camera_m_s;
      EXPECT_NEAR(found[0].velocity_m_s.tail<2>().norm(), 0, 0.05) << camera_m_s;
    }
  }
}

TEST(PeopleInMap, APersonThatIsNotSeenIsNotPlaced) {
  Scene scene(200);
  PeopleInMap people;
  TrackedPerson unseen = scene.tracked;
  unseen.id = 4;
  unseen.cells.clear();
  const auto found =
      people.place({unseen, scene.tracked}, scene.grid, Eigen::Isometry3d::Identity(), kFrame_ns);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].id, 3);
}

TEST(PeopleInMap, AfterALossNoPersonHasAVelocity) {
  PeopleInMap people;
  const Scene before(100), after(400);
  people.place({before.tracked}, before.grid, Eigen::Isometry3d::Identity(), kFrame_ns);
  people.reset();
  const auto found =
      people.place({after.tracked}, after.grid, Eigen::Isometry3d::Identity(), 2 * kFrame_ns);
  EXPECT_EQ(found.at(0).velocity_m_s.norm(), 0);
}

TEST(MovingObject, InAnotherFrameItIsTheSameBody) {
  const Scene scene(200);
  PeopleInMap people;
  people.place({scene.tracked}, scene.grid, Eigen::Isometry3d::Identity(), kFrame_ns);
  const Scene next(230);
  const MovingObject here =
      people.place({next.tracked}, next.grid, Eigen::Isometry3d::Identity(), 2 * kFrame_ns).at(0);
  Eigen::Isometry3d T =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized());
  const MovingObject there = here.in(T);
  EXPECT_NEAR((there.centre_m - T * here.centre_m).norm(), 0, 1e-9);
  EXPECT_NEAR(there.velocity_m_s.norm(), here.velocity_m_s.norm(), 1e-9);
  EXPECT_GT(here.velocity_m_s.norm(), 0.1);
  for (const Eigen::Vector3f& point : there.points_m) {
    EXPECT_TRUE(there.box_m().contains(point.cast<double>()));
  }
  const MovingObject back = there.in(T.inverse());
  EXPECT_NEAR((back.box_m().min() - here.box_m().min()).norm(), 0, 1e-5);
  EXPECT_NEAR((back.joints_m[3] - here.joints_m[3]).norm(), 0, 1e-5);
}

}  // namespace
}  // namespace pf

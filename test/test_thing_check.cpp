// SPDX-License-Identifier: BSD-3-Clause
// A board that is moved before a wall: what a map has of its old place.
#include "posefusion/evaluation/thing_check.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "posefusion/evaluation/place_watch.hpp"
#include "posefusion/run/mask_folders.hpp"
#include "temporary_folder.hpp"

namespace pf {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// Points 1 cm apart of an upright square board of 0.4 m in the plane x = 0, facing -x.
std::vector<SurfacePoint> board() {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 40; ++i) {
    for (int k = 0; k < 40; ++k) {
      SurfacePoint point;
      point.position = {0.0F, 0.01F * static_cast<float>(i), 0.01F * static_cast<float>(k)};
      point.normal = -Eigen::Vector3f::UnitX();
      points.push_back(point);
    }
  }
  return points;
}

Eigen::Isometry3d at(double x, double y) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, 0.0));
}

/// From (2, 0) to (2, 1) between 1 s and 2 s.
RecordedThing movedBoard() {
  RecordedThing thing;
  thing.name = "board";
  thing.points = board();
  thing.moves.push_back({kSecond_ns, 2 * kSecond_ns, at(2, 0), at(2, 1)});
  for (int i = 0; i <= 100; ++i) {
    thing.poses.push_back({kSecond_ns + i * kSecond_ns / 100, at(2, 0.01 * i)});
  }
  return thing;
}

std::vector<Eigen::Vector3f> boardAt(const Eigen::Isometry3d& pose) {
  std::vector<Eigen::Vector3f> points;
  for (const SurfacePoint& p : board()) points.push_back(pose.cast<float>() * p.position);
  return points;
}

SurfaceSamples sceneAtTheEnd() {
  SurfaceSamples scene;
  scene.positions = boardAt(at(2, 1));
  scene.normals.assign(scene.positions.size(), -Eigen::Vector3f::UnitX());
  return scene;
}

TEST(ThingCheck, WhatIsOfTheEndIsNoRemains) {
  const RemainsScore score = checkRemains(boardAt(at(2.03, 1)), sceneAtTheEnd(), {movedBoard()});
  EXPECT_EQ(score.surfels, 1600U);
  EXPECT_EQ(score.remains(), 0U);
  EXPECT_EQ(score.share(), 0.0);
}

TEST(ThingCheck, RemainsAreCountedWhereTheThingStoodAndOnItsWay) {
  const RemainsScore old = checkRemains(boardAt(at(2.02, 0)), sceneAtTheEnd(), {movedBoard()});
  EXPECT_EQ(old.things.at(0).at_old_places, 1600U);
  EXPECT_EQ(old.things.at(0).on_the_way, 0U);
  EXPECT_EQ(old.share(), 1.0);
  // Between the two places, out of reach of both.
  const std::vector<Eigen::Vector3f> between(7, Eigen::Vector3f(2.0F, 0.7F, 0.2F));
  const RemainsScore way = checkRemains(between, sceneAtTheEnd(), {movedBoard()});
  EXPECT_EQ(way.things.at(0).at_old_places, 0U);
  EXPECT_EQ(way.things.at(0).on_the_way, 7U);
}

TEST(ThingCheck, WhatNoThingExplainsIsNoRemains) {
  const RemainsScore score = checkRemains(boardAt(at(2.2, 0)), sceneAtTheEnd(), {movedBoard()});
  EXPECT_EQ(score.surfels, 1600U);
  EXPECT_EQ(score.remains(), 0U);
  EXPECT_EQ(checkRemains({}, sceneAtTheEnd(), {movedBoard()}).share(), 0.0);
}

/// A camera at the origin that looks along x.
struct View {
  View() : camera{160, 120, 150.0, 150.0, 79.5, 59.5}, map(MapConfig{}) {
    T_world_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    T_world_camera.translation() << 0, 0.2, 0.2;
    map.advance();
  }
  void putBoard(const Eigen::Isometry3d& pose) {
    SurfelArrays s;
    for (const Eigen::Vector3f& p : boardAt(pose)) {
      s.forEachArray([](auto& array) { array.push_back(0); });
      s.x.back() = p.x(), s.y.back() = p.y(), s.z.back() = p.z();
      s.nx.back() = -1.0F;
      s.radius.back() = 0.01F;
      s.odds.back() = static_odds::kMost;
    }
    map.add(s);
  }
  MappedView after(double time_s, float depth) {
    depth_m = cv::Mat(120, 160, CV_32FC1, cv::Scalar(depth));
    return {static_cast<std::int64_t>(time_s * 1e9), depth_m, camera, T_world_camera,
            Eigen::Isometry3d::Identity(),           map};
  }

  PinholeCamera camera;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  SurfelMap map;
  cv::Mat depth_m;
};

std::vector<Eigen::Vector3d> pointsAt(const Eigen::Isometry3d& pose) {
  std::vector<Eigen::Vector3d> points;
  for (const SurfacePoint& p : board()) points.emplace_back(pose * p.position.cast<double>());
  return points;
}

TEST(PlaceWatch, AnOldPlaceIsForgottenOnceItsSurfelsAreGone) {
  View view;
  view.putBoard(at(2, 0));
  PlaceWatch place(PlaceWatch::Kind::left, pointsAt(at(2, 0)));
  place.add(view.after(1, 2.0F));
  EXPECT_EQ(place.known(), 1600U);
  place.add(view.after(2, 2.0F));  // it stands there yet
  EXPECT_FALSE(place.seenAt());
  place.add(view.after(3, 4.0F));  // a wall far behind
  EXPECT_EQ(place.seenAt(), 3 * kSecond_ns);
  EXPECT_FALSE(place.toldAt());
  EXPECT_EQ(place.mapped(), 1.0);
  view.map.removeIf([](const SurfelArrays&, std::size_t) { return true; });
  place.add(view.after(5, 4.0F));
  EXPECT_EQ(place.seenAt(), 3 * kSecond_ns);
  EXPECT_EQ(place.toldAt(), 5 * kSecond_ns);
}

TEST(PlaceWatch, OnlyTheTimeCountsInWhichThePlaceIsInView) {
  View view;
  view.putBoard(at(2, 0));
  PlaceWatch place(PlaceWatch::Kind::left, pointsAt(at(2, 0)));
  place.add(view.after(1, 2.0F));
  place.add(view.after(2, 4.0F));
  EXPECT_EQ(place.inViewS(), 0.0);
  place.add(view.after(4, 4.0F));
  place.add(view.after(9, 1.0F));  // something stands before it
  view.map.removeIf([](const SurfelArrays&, std::size_t) { return true; });
  place.add(view.after(10, 4.0F));
  EXPECT_EQ(place.toldAt(), 10 * kSecond_ns);
  EXPECT_NEAR(place.inViewS(), 3.0, 1e-9);
}

TEST(PlaceWatch, APlaceThatWasNeverMappedIsNotSeenToBeLeft) {
  View view;
  PlaceWatch place(PlaceWatch::Kind::left, pointsAt(at(2, 0)));
  for (int i = 1; i < 4; ++i) place.add(view.after(i, 4.0F));
  EXPECT_EQ(place.known(), 0U);
  EXPECT_FALSE(place.seenAt());
}

TEST(PlaceWatch, ANewPlaceIsMappedOnceSurfelsAreThere) {
  View view;
  PlaceWatch place(PlaceWatch::Kind::taken, pointsAt(at(2, 0)));
  place.add(view.after(1, 4.0F));  // not seen: the depth is of what lies behind
  EXPECT_FALSE(place.seenAt());
  place.add(view.after(2, 2.0F));
  EXPECT_EQ(place.seenAt(), 2 * kSecond_ns);
  EXPECT_EQ(place.mapped(), 0.0);
  view.putBoard(at(2.02, 0));
  place.add(view.after(3, 2.0F));
  EXPECT_EQ(place.toldAt(), 3 * kSecond_ns);
}

TEST(ThingMasks, WhatMovesAndWhatStandsAreCountedApartFromPeople) {
  const TemporaryFolder folder;
  const auto save = [&](const std::string& name, const cv::Rect& part) {
    cv::Mat mask = cv::Mat::zeros(10, 20, CV_8UC1);
    mask(part) = 255;
    folder.write(name, "");
    cv::imwrite(folder / name, mask);
  };
  save("sequence/mask/1.000000.png", {0, 0, 5, 10});
  save("sequence/thing_mask/1.000000.png", {5, 0, 10, 10});
  save("run/mask/1.000000.png", {0, 0, 8, 10});  // the person and 3 of 10 columns
  const ThingMaskScore score = checkThingMasks(folder / "sequence", folder / "run");
  EXPECT_EQ(score.frames, 1);
  EXPECT_DOUBLE_EQ(score.masked_things, 0.3);
  EXPECT_EQ(score.masked_still, 0.0);
  save("run/mask/1.000000.png", {15, 0, 1, 10});  // one of 5 columns beside
  EXPECT_DOUBLE_EQ(checkThingMasks(folder / "sequence", folder / "run").masked_still, 0.2);
  EXPECT_NE(errorOf([&] { checkThingMasks(folder / "run", folder / "run"); }).find("thing_mask"),
            std::string::npos);
}

TEST(ThingsFile, ASequenceWithoutThingsIsRefused) {
  const TemporaryFolder folder;
  folder.write("events.json", R"({"events": []})");
  const std::string error = errorOf([&] { loadThings(folder.str()); });
  EXPECT_NE(error.find("events.json: has no things"), std::string::npos) << error;
  folder.write("events.json", R"({"things": [{"name": "a", "moves": [{"begin": "1.0"}]}]})");
  EXPECT_NE(errorOf([&] { loadThings(folder.str()); }).find("events.json"), std::string::npos);
  folder.write("events.json", R"({"things": [{"name": "a", "moves": []}]})");
  EXPECT_NE(errorOf([&] { loadThings(folder.str()); }).find("things/1.txt"), std::string::npos);
}

}  // namespace
}  // namespace pf

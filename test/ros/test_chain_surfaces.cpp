// SPDX-License-Identifier: BSD-3-Clause
// What a chain gives to others while it runs: the map as a mesh, and as a grid.
#include <gtest/gtest.h>
#include <nav_msgs/OccupancyGrid.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "posefusion/io/mesh_file.hpp"
#include "posefusion_ros/surface_output.hpp"
#include "saving_fixture.hpp"

namespace posefusion_ros {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

class ChainSurfaces : public ChainSaving {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    chain.emplace(std::string("surfaces_") + test->name());
    chain->set("output", folder / "out");
    chain->set("mesh_period_s", 0.1);
    chain->set("grid_period_s", 0.1);
  }
  void map(int count) {
    ASSERT_TRUE(chain->load());
    for (int i = 0; i < count; ++i) process(i);
  }
};

/// Keeps what a viewer would show.
class Viewer {
 public:
  explicit Viewer(Chain& chain)
      : mesh_(chain.handle().subscribe(topics::kMesh, 100, &Viewer::onMesh, this)),
        grid_(chain.handle().subscribe(topics::kGrid, 100, &Viewer::onGrid, this)) {}

  std::size_t triangles() const {
    const std::lock_guard<std::mutex> guard(mutex_);
    std::size_t sum = 0;
    for (const auto& [id, marker] : shown_) sum += marker.points.size() / 3;
    return sum;
  }
  std::map<int, Marker> shown() const {
    const std::lock_guard<std::mutex> guard(mutex_);
    return shown_;
  }
  nav_msgs::OccupancyGrid grid() const {
    const std::lock_guard<std::mutex> guard(mutex_);
    return grid_message_ ? *grid_message_ : nav_msgs::OccupancyGrid();
  }
  bool hasBoth() const {
    return Chain::waitUntil([&] { return triangles() > 0 && grid().info.width > 0; });
  }

 private:
  void onMesh(const MarkerArray::ConstPtr& message) {
    const std::lock_guard<std::mutex> guard(mutex_);
    for (const Marker& marker : message->markers) {
      if (marker.action == Marker::DELETEALL) shown_.clear();
      if (marker.action == Marker::DELETE) shown_.erase(marker.id);
      if (marker.action == Marker::ADD) shown_[marker.id] = marker;
    }
  }
  void onGrid(const nav_msgs::OccupancyGrid::ConstPtr& message) {
    const std::lock_guard<std::mutex> guard(mutex_);
    grid_message_ = message;
  }

  mutable std::mutex mutex_;
  std::map<int, Marker> shown_;
  nav_msgs::OccupancyGrid::ConstPtr grid_message_;
  ros::Subscriber mesh_, grid_;
};

TEST_F(ChainSurfaces, MeshAndGridComeToSubscribersAndFollowTheMap) {
  map(12);
  const Viewer viewer(*chain);
  ASSERT_TRUE(viewer.hasBoth()) << "no frame comes: they are made for a new subscriber";
  const std::size_t before = viewer.triangles();
  for (const auto& [id, marker] : viewer.shown()) {
    EXPECT_EQ(marker.header.frame_id, "map");
    EXPECT_EQ(marker.type, Marker::TRIANGLE_LIST);
    EXPECT_EQ(marker.points.size() % 3, 0U);
    EXPECT_EQ(marker.colors.size(), marker.points.size());
  }
  const auto grid = viewer.grid();
  EXPECT_EQ(grid.header.frame_id, "map");
  EXPECT_EQ(grid.data.size(), grid.info.width * grid.info.height);
  EXPECT_GT(std::count(grid.data.begin(), grid.data.end(), 0), 50) << "free";
  for (int i = 12; i < 40; ++i) {
    process(i);
    // The mesh is made at its own pace, of a map that frames still come to: the last ones come
    // slowly.
    ros::WallDuration(i < 35 ? 0.2 : 1.0).sleep();
  }
  EXPECT_TRUE(Chain::waitUntil([&] { return viewer.triangles() > 1.05 * before; }))
      << viewer.triangles() << " after " << before;
}

TEST_F(ChainSurfaces, ANewcomerGetsAllOfTheMesh) {
  map(20);
  const Viewer first(*chain);
  ASSERT_TRUE(first.hasBoth());
  const Viewer second(*chain);
  EXPECT_TRUE(Chain::waitUntil([&] { return second.triangles() >= first.triangles(); }));
  EXPECT_GT(second.triangles(), 1000U);
}

TEST_F(ChainSurfaces, AnEmptiedMapTakesTheOldMeshAway) {
  map(20);
  const Viewer viewer(*chain);
  ASSERT_TRUE(viewer.hasBoth());
  const std::size_t before = viewer.triangles();
  ASSERT_TRUE(chain->call("reset").success);
  process(20);
  process(21);
  process(22);
  EXPECT_TRUE(Chain::waitUntil([&] { return viewer.triangles() < before; }));
}

TEST(SurfaceOutput, NoSnapshotIsTakenWithoutSubscribersOrBeforeItIsDue) {
  ros::NodeHandle handle("/surface_output");
  int wanted = 0, taken = 0;
  const auto take = [&](const ros::Time&) -> std::shared_ptr<const MapSnapshot> {
    ++taken;
    return nullptr;  // the map frame is not known
  };
  std::mutex mutex;
  SurfaceOutput output(handle, {}, {}, "map", [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    ++wanted;
  });
  output.offer(ros::Time(1), take);
  EXPECT_EQ(taken, 0);
  const boost::function<void(const MarkerArray::ConstPtr&)> nothing =
      [](const MarkerArray::ConstPtr&) {};
  const ros::Subscriber listener = handle.subscribe<MarkerArray>(topics::kMesh, 1, nothing);
  EXPECT_TRUE(Chain::waitUntil([&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return wanted > 0;
  }));
  output.offer(ros::Time(1), take);
  EXPECT_EQ(taken, 1);
  const auto give = [&](const ros::Time& stamp) {
    ++taken;
    return std::make_shared<const MapSnapshot>(
        MapSnapshot{pf::SurfelMap{pf::MapConfig{}}, {}, {}, Eigen::Isometry3d::Identity(), stamp});
  };
  output.offer(ros::Time(1), give);
  EXPECT_EQ(taken, 2) << "what was not had is still due";
  EXPECT_TRUE(Chain::waitUntil([&] {
    output.offer(ros::Time(2), give);  // nothing, however often it is requested
    output.offer(ros::Time(3.5), give);
    return taken > 2;
  }));
  EXPECT_EQ(taken, 3);
  output.close();
  output.offer(ros::Time(100), give);
  EXPECT_EQ(taken, 3);
}

TEST_F(ChainSurfaces, TheMeshIsSavedOnRequest) {
  ASSERT_TRUE(chain->load());
  const auto none = chain->call("save_mesh");
  EXPECT_FALSE(none.success);
  EXPECT_NE(none.message.find("0 stable surfels are too few"), std::string::npos) << none.message;
  for (int i = 0; i < 12; ++i) process(i);
  const auto saved = chain->call("save_mesh");
  ASSERT_TRUE(saved.success) << saved.message;
  const std::string path = saved.message.substr(saved.message.rfind(' ') + 1);
  const pf::TriangleMesh mesh = pf::loadMesh(path + "/mesh.ply");
  EXPECT_GT(mesh.triangles.size(), 1000U);
  EXPECT_NE(saved.message.find(std::to_string(mesh.triangles.size()) + " triangles"),
            std::string::npos)
      << saved.message;
}

TEST_F(ChainSurfaces, AMeshThatCannotBeWrittenIsReportedAndTheChainGoesOn) {
  map(12);
  std::filesystem::rename(folder / "out", folder / "gone");
  std::ofstream(folder / "out") << "a file in the way";
  const auto refused = chain->call("save_mesh");
  EXPECT_FALSE(refused.success);
  EXPECT_NE(refused.message.find("out"), std::string::npos) << refused.message;
  std::filesystem::remove(folder / "out");
  std::filesystem::rename(folder / "gone", folder / "out");
  EXPECT_EQ(outcome(process(12)), TrackingStatusMsg::FUSED);
}

}  // namespace
}  // namespace posefusion_ros

// SPDX-License-Identifier: BSD-3-Clause
// For the bench: how fluid the display posefusion/Surfels is. A room of so many surfels is shown in
// rviz's own window, the view turns about it, and frames are counted once the display has settled.
#include <Ogre.h>
#include <ros/ros.h>
#include <rviz/display.h>
#include <rviz/properties/property.h>
#include <rviz/render_panel.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>
#include <rviz/visualization_manager.h>

#include <QApplication>
#include <QTimer>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <random>

#include "posefusion_ros/surfel_cloud.hpp"
#include "tools/tool.hpp"

namespace {

using posefusion_ros::SurfelPoint;
using std::chrono::steady_clock;

constexpr char kTopic[] = "viewer_speed_surfels";
constexpr float kTurn_rad = 0.02F;  // from one frame to the next
constexpr int kTick_ms = 15;

struct Options {
  int surfels = 1000000;
  bool keep_fluid = true;
  double settle_s = 40, seconds = 10;
  std::string picture;
};

/// Sides of a box, seen from inside or from outside: middle, half sizes along two axes, normal.
struct Side {
  Eigen::Vector3f middle, u, v, normal;
  float area() const { return 4 * u.norm() * v.norm(); }
};

void addBox(std::vector<Side>& sides, const Eigen::Vector3f& middle, const Eigen::Vector3f& half,
            bool inside) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0F, 1.0F}) {
      const Eigen::Vector3f out = sign * Eigen::Vector3f::Unit(axis);
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      sides.push_back({middle + out * half[axis], Eigen::Vector3f::Unit(b) * half[b],
                       Eigen::Vector3f::Unit(c) * half[c], inside ? Eigen::Vector3f(-out) : out});
    }
  }
}

float colorAt(float u, float v, std::size_t side) {
  const bool odd = (static_cast<int>(std::floor(4 * u)) + static_cast<int>(std::floor(4 * v))) & 1;
  const std::uint32_t level = odd ? 200 : 120, tint = static_cast<std::uint32_t>(side * 37 % 90);
  const std::uint32_t bits = (level - tint) << 16 | level << 8 | (level - 90 + tint);
  float rgb = 0;
  std::memcpy(&rgb, &bits, sizeof rgb);
  return rgb;
}

/// A room with furniture, its walls covered evenly and without holes.
std::vector<SurfelPoint> room(int count) {
  std::vector<Side> sides;
  addBox(sides, {0, 0, 1.2F}, {4, 3, 1.2F}, true);
  addBox(sides, {1, 1, 0.4F}, {0.8F, 0.5F, 0.4F}, false);
  addBox(sides, {-2, -1, 0.9F}, {0.4F, 0.9F, 0.9F}, false);
  float area = 0;
  for (const Side& side : sides) area += side.area();
  const float radius = 1.1F * std::sqrt(area / static_cast<float>(count));
  std::mt19937 random(1);
  std::uniform_real_distribution<float> part(-1, 1);
  std::vector<SurfelPoint> points;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Side& side = sides[i];
    const int here = static_cast<int>(static_cast<float>(count) * side.area() / area);
    for (int k = 0; k < here; ++k) {
      const float u = part(random), v = part(random);
      const Eigen::Vector3f p = side.middle + u * side.u + v * side.v, &n = side.normal;
      points.push_back({p.x(), p.y(), p.z(), colorAt(u * side.u.norm(), v * side.v.norm(), i),
                        n.x(), n.y(), n.z(), radius, 10});
    }
  }
  return points;
}

class Viewer {
 public:
  explicit Viewer(const Options& options) : options_(options), manager_(&panel_) {
    panel_.resize(1100, 800);
    panel_.initialize(manager_.getSceneManager(), &manager_);
    manager_.initialize();
    manager_.setFixedFrame("map");
    manager_.startUpdate();
    panel_.show();
    publisher_ = handle_.advertise<sensor_msgs::PointCloud2>(kTopic, 1, true);
    const auto cloud = posefusion_ros::toCloud(room(options.surfels));
    cloud->header.frame_id = "map";
    publisher_.publish(cloud);
    display_ = manager_.createDisplay("posefusion/Surfels", "Surfels", true);
    display_->subProp("Keep Fluid")->setValue(options.keep_fluid);
    display_->subProp("Topic")->setValue(kTopic);
    QObject::connect(&timer_, &QTimer::timeout, [this] { look(); });
    timer_.start(kTick_ms);
  }

 private:
  static double since(steady_clock::time_point begin) {
    return std::chrono::duration<double>(steady_clock::now() - begin).count();
  }

  /// The status text of the cloud in the display.
  QString told() const {
    for (int i = 0; i < display_->numChildren(); ++i) {
      const rviz::Property* child = display_->childAt(i);
      if (!child->getName().startsWith("Status")) continue;
      for (int k = 0; k < child->numChildren(); ++k) {
        if (child->childAt(k)->getName() == "Message") {
          return child->childAt(k)->getValue().toString();
        }
      }
    }
    return "nothing is shown";
  }

  /// Turns the view, as a user does, and counts once it is time.
  void look() {
    rviz::Property* yaw = manager_.getViewManager()->getCurrent()->subProp("Yaw");
    yaw->setValue(yaw->getValue().toFloat() + kTurn_rad);
    if (!counting_ && since(begin_) > options_.settle_s) {
      counting_ = true;
      begin_ = steady_clock::now();
      first_ = manager_.getFrameCount();
      first_clock_ = std::clock();
    }
    if (!counting_ || since(begin_) < options_.seconds) return;
    timer_.stop();
    const double frames = static_cast<double>(manager_.getFrameCount() - first_);
    const double processor_s = static_cast<double>(std::clock() - first_clock_) / CLOCKS_PER_SEC;
    std::printf("%.2f frames/s, %.0f ms of processor time each; %s\n", frames / since(begin_),
                1e3 * processor_s / std::max(1.0, frames), qPrintable(told()));
    if (!options_.picture.empty()) {
      panel_.getRenderWindow()->writeContentsToFile(options_.picture);
    }
    QApplication::quit();
  }

  Options options_;
  ros::NodeHandle handle_;
  ros::Publisher publisher_;
  rviz::RenderPanel panel_;
  rviz::VisualizationManager manager_;
  rviz::Display* display_ = nullptr;
  QTimer timer_;
  steady_clock::time_point begin_ = steady_clock::now();
  bool counting_ = false;
  std::uint64_t first_ = 0;
  std::clock_t first_clock_ = 0;  // of all threads: software rendering has some
};

}  // namespace

int main(int argc, char** argv) {
  pf::CommandLine app{"Frames per second at which rviz shows a room of surfels.",
                      "posefusion_viewer_speed"};
  Options options;
  app.addOption("--surfels", options.surfels)->check(pf::positive());
  app.addOption("--keep-fluid", options.keep_fluid);
  app.addOption("--settle", options.settle_s, "seconds before it counts");
  app.addOption("--seconds", options.seconds, "that it counts for");
  app.addOption("--picture", options.picture, "what is seen at the end (PNG)");
  return pf::runTool(app, argc, argv, [&] {
    QApplication application(argc, argv);
    ros::init(argc, argv, "viewer_speed", ros::init_options::NoSigintHandler);
    ros::AsyncSpinner spinner(1);
    spinner.start();
    Viewer viewer(options);
    return QApplication::exec();
  });
}
